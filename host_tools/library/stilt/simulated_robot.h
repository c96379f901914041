#pragma once

#include <stilt/types.h>

#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <vector>

namespace stilt {

/// The robot of `stilt sim` in MuJoCo, for loops of the user's own (docs/library.md). It stands on its feet
/// at the start. The same settings, seed and calls give the same results, bit for bit.
class SimulatedRobot {
 public:
  /// Of the robot and configuration of a controller. `plant`: "KEY=VALUE" as of `stilt sim --plant`. The
  /// error is one sentence.
  [[nodiscard]] static std::expected<SimulatedRobot, std::string> create(
      const Settings& settings, const std::vector<std::string>& plant = {}, std::uint64_t seed = 1);

  SimulatedRobot(SimulatedRobot&&) noexcept;
  SimulatedRobot& operator=(SimulatedRobot&&) noexcept;
  ~SimulatedRobot();

  /// Reads the sensors, with their noise. Once per tick.
  [[nodiscard]] Measurements read();

  /// Commands of a controller to the drivers, until the next call.
  void drive(const Tick& tick);

  /// Simulates one period of the torque loop.
  void advance();

  /// Horizontal force on the hip from now on, positive forward.
  void push(double force_N);

  [[nodiscard]] double time_s() const noexcept;
  [[nodiscard]] double hip_x_m() const;
  [[nodiscard]] bool fallen() const;
  /// True state [q; v].
  [[nodiscard]] std::array<double, kStateCount> state() const;

 private:
  struct Parts;
  explicit SimulatedRobot(std::unique_ptr<Parts> parts) noexcept;
  std::unique_ptr<Parts> parts_;
};

}  // namespace stilt
