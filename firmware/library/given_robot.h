#pragma once

#include <stilt/types.h>

#include "hal/robot/robot.h"
#include "hal/sensors/torso_measurement.h"

namespace stilt::library {

/// The robot of the user's loop behind the interface of the control loop. Measurements are given before a
/// tick, what to do is taken after it. Real-time safe.
class GivenRobot final : public hal::Robot {
 public:
  /// @param torso_period_ticks  from one reading of the torso to the next, at least 1
  explicit GivenRobot(int torso_period_ticks) noexcept
      : torso_({.period_reads = static_cast<std::uint32_t>(torso_period_ticks)}) {}

  /// Before a tick.
  void give(const Measurements& measurements) noexcept;

  /// After a tick.
  [[nodiscard]] DriverAction action() const noexcept { return action_; }
  [[nodiscard]] const JointTargets& targets() const noexcept { return targets_; }

  void read(std::int64_t now_ns, hal::RobotReadings& readings) noexcept override;
  [[nodiscard]] hal::JointBusStatus write(const hal::JointCommands& commands) noexcept override;
  [[nodiscard]] hal::JointBusStatus disable() noexcept override;
  void begin_bring_up() noexcept override {}
  [[nodiscard]] hal::BringUpProgress bring_up(std::int64_t now_ns) noexcept override;
  void restore_buses() noexcept override {}

 private:
  Measurements given_;
  hal::TorsoMeasurement torso_;
  DriverAction action_ = DriverAction::none;
  JointTargets targets_{};
};

}  // namespace stilt::library
