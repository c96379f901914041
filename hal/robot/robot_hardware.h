#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/robot/can_drivers.h"
#include "hal/robot/can_robot.h"
#include "hal/robot/robot.h"
#include "hal/robot/tap_bus.h"

namespace stilt::hal {

/// The robot behind its buses, whatever carries them: joints, sensors of the torso, emergency stop, bring-up
/// of the drivers. Fixed memory, does not move.
class RobotHardware final : public Robot {
 public:
  /// @param buses  in the order of their numbers in the wiring, outlive this object
  RobotHardware(const RobotWiring& wiring, const BringUpOptions& options,
                std::span<FrameBus* const> buses) noexcept;
  RobotHardware(const RobotHardware&) = delete;
  RobotHardware& operator=(const RobotHardware&) = delete;

  void read(std::int64_t now_ns, RobotReadings& readings) noexcept override;
  [[nodiscard]] JointBusStatus write(const JointCommands& commands) noexcept override {
    return robot_.write(commands);
  }
  [[nodiscard]] JointBusStatus disable() noexcept override { return robot_.disable(); }
  void begin_bring_up() noexcept override { drivers_.begin(); }
  [[nodiscard]] BringUpProgress bring_up(std::int64_t now_ns) noexcept override {
    return drivers_.step(now_ns);
  }
  [[nodiscard]] std::optional<std::size_t> void_offset() const noexcept override {
    return drivers_.void_offset();
  }
  void restore_buses() noexcept override;

  /// False: the angle of a joint that is up may be wrong by whole turns of its driver's encoder.
  [[nodiscard]] bool turn_known(std::size_t joint) const noexcept { return drivers_.turn_known(joint); }

  /// Frames lost, withheld or malformed and error reports, on all buses since the start.
  [[nodiscard]] std::uint64_t errors() const noexcept;
  [[nodiscard]] std::uint64_t errors(std::size_t bus) const noexcept;

  /// Takes the torso sensor's samples from here. At start-up; outlives this object.
  void attach(TorsoFeed& feed) noexcept { robot_.attach(feed); }

  /// Why the torso sensor does not report, as far as it reports that. From any thread.
  [[nodiscard]] canopen::EncoderTrouble torso_sensor_trouble() const noexcept {
    return robot_.torso_sensor_trouble();
  }

  /// The other half of restore_buses(), on any thread but the torque loop's: connects the buses again that
  /// restore_buses() found gone. Opens sockets; not real time.
  /// @param connect  connects a bus, known to who opened them; tried again by the next restore_buses() when
  /// it fails
  template <class Connect>
  void serve_restore(Connect&& connect) {
    for (std::size_t bus = 0; bus < bus_count_; ++bus) {
      if (!taps_[bus].reconnecting()) continue;
      connect(bus);
      taps_[bus].end_reconnect();
    }
  }

  /// The buses as joints and sensors are read from them.
  [[nodiscard]] std::span<TapBus> buses() noexcept { return std::span(taps_).first(bus_count_); }

 private:
  [[nodiscard]] BusStates bus_states() noexcept;

  std::size_t bus_count_;
  std::array<std::uint64_t, kMaximumBuses> errors_before_{};
  std::array<TapBus, kMaximumBuses> taps_;
  std::array<FrameBus*, kMaximumBuses> tap_pointers_;
  CanRobot robot_;
  CanDrivers drivers_;
};

}  // namespace stilt::hal
