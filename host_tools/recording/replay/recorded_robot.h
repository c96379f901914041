#pragma once

#include "firmware/control_loop/tick_record.h"
#include "hal/robot/robot.h"

namespace stilt::replay {

/// The robot in a recorded tick: the control loop reads the recorded inputs, and its commands are discarded.
class RecordedRobot final : public hal::Robot {
 public:
  /// Sets the tick to run, which must outlive its use.
  void set(const control_loop::TickRecord& tick) noexcept { tick_ = &tick; }

  void read(std::int64_t, hal::RobotReadings& readings) noexcept override {
    readings = {tick_->joints, tick_->base, tick_->read_status, tick_->emergency_stop, tick_->bus_errors, {}};
  }
  [[nodiscard]] hal::JointBusStatus write(const hal::JointCommands&) noexcept override {
    return tick_->write_status;
  }
  [[nodiscard]] hal::JointBusStatus disable() noexcept override { return tick_->write_status; }
  void begin_bring_up() noexcept override {}
  [[nodiscard]] hal::BringUpProgress bring_up(std::int64_t) noexcept override { return tick_->bring_up; }
  void restore_buses() noexcept override {}

 private:
  const control_loop::TickRecord* tick_ = nullptr;
};

}  // namespace stilt::replay
