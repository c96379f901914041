#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/ak/ak_bring_up.h"
#include "hal/mit/mit_bring_up.h"
#include "hal/moteus/moteus_bring_up.h"
#include "hal/odrive/odrive_bring_up.h"
#include "hal/robot/can_robot.h"
#include "hal/robot/robot.h"
#include "hal/robot/robot_wiring.h"
#include "hal/robot/tap_bus.h"

namespace stilt::hal {

/// What the bring-up of each joint's driver shall require.
using BringUpOptions = std::array<bring_up::Options, kJoints>;

/// Drivers on buses: the step functions of hal/bring_up, one driver per bus at a time. Drivers of one vendor
/// share identifiers while they are asked for registers. Fixed memory.
class CanDrivers final {
 public:
  /// @param taps   one per bus, read by `robot`; outlive this object
  /// @param robot  receives the whole turns of the encoders
  CanDrivers(const RobotWiring& wiring, const BringUpOptions& options, std::span<TapBus> taps,
             CanRobot& robot) noexcept;

  /// Starts over, from whatever state the drivers are in.
  void begin() noexcept;
  /// One step, once per tick, after the buses were read and instead of a command.
  [[nodiscard]] BringUpProgress step(std::int64_t now_ns) noexcept;

  /// Once per read, after it. Silence while an answer was due may be a loss of power, or of a cable.
  /// A driver that was up before and counts from power-up may have lost its zero: every later step fails.
  void watch() noexcept;

  /// The first joint with such a driver.
  [[nodiscard]] std::optional<std::size_t> void_offset() const noexcept;

  /// False: the angle of a joint that is up may be wrong by whole turns of its driver's encoder.
  [[nodiscard]] bool turn_known(std::size_t joint) const noexcept {
    const auto* moteus = std::get_if<moteus::MoteusBringUp>(&bring_up_[joint]);
    return moteus == nullptr || moteus->turn_known();
  }

 private:
  [[nodiscard]] bring_up::BringUp& of(std::size_t joint) noexcept;
  /// Of drivers that keep a fault until they are cleared; the others clear theirs when stopped.
  void clear_latched_faults() noexcept;
  /// Whether an earlier driver on the same bus is still at work.
  [[nodiscard]] bool must_wait(std::size_t joint) noexcept;
  /// Whether a driver that has its power sends a new position for every read.
  [[nodiscard]] bool answers(std::size_t joint) noexcept;
  void step_joint(std::int64_t now_ns, std::size_t joint, BringUpProgress& progress) noexcept;

  RobotWiring wiring_;
  std::span<TapBus> taps_;
  CanRobot& robot_;
  std::array<JointBringUp, kJoints> bring_up_;
  bool beginning_ = true;
  std::int64_t rest_until_ns_ = 0;
  bool stepped_ = false;                          ///< since the newest read
  std::array<bool, kJoints> loses_zero_{};        ///< without power
  std::array<bool, kJoints> was_up_{};            ///< since the start
  std::array<unsigned, kJoints> silent_reads_{};  ///< in a row, with an answer due
  std::array<bool, kJoints> offset_is_void_{};    ///< until the end
};

}  // namespace stilt::hal
