#pragma once

#include "firmware/controller/torque_cycle.h"
#include "firmware/diagnostics/tick_record.h"

namespace stilt::replay {

/// The robot as it was in a recorded tick: the torque loop reads what it read then, and its commands come to
/// nothing.
class RecordedRobot final : public hal::JointBus,
                            public hal::BaseSensor,
                            public hal::EmergencyStop,
                            public hardware::Drivers,
                            public hardware::Buses {
 public:
  /// The tick that is to run; outlives it.
  void set(const diagnostics::TickRecord& tick) noexcept { tick_ = &tick; }

  [[nodiscard]] controller::Robot parts() noexcept { return {this, this, this, this, this}; }

  [[nodiscard]] hal::JointBusStatus read(std::int64_t, hal::JointReadings& readings) noexcept override {
    readings = tick_->joints;
    return tick_->read_status;
  }
  [[nodiscard]] hal::JointBusStatus write(const hal::JointCommands&) noexcept override {
    return tick_->write_status;
  }
  [[nodiscard]] hal::JointBusStatus disable() noexcept override { return tick_->write_status; }
  [[nodiscard]] hal::BaseSensorStatus read_base(hal::BaseReading& reading) noexcept override {
    reading = tick_->base;
    return reading.missed == 0 ? hal::BaseSensorStatus::ok : hal::BaseSensorStatus::stale;
  }
  [[nodiscard]] hal::EmergencyStopState read_emergency_stop(std::int64_t) noexcept override {
    return tick_->emergency_stop;
  }
  void begin() noexcept override {}
  [[nodiscard]] hardware::DriversProgress step(std::int64_t) noexcept override { return tick_->bring_up; }
  [[nodiscard]] std::uint64_t errors() const noexcept override { return tick_->bus_errors; }
  void restore() noexcept override {}

 private:
  const diagnostics::TickRecord* tick_ = nullptr;
};

}  // namespace stilt::replay
