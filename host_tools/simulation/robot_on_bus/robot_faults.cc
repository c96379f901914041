// Faults of the robot that begin and end at their times.
#include <linux/can/error.h>

#include <algorithm>

#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"

namespace stilt::robot_on_bus {
namespace {

constexpr double kLowSupply_V = 30.0;
constexpr double kNominalSupply_V = 48.0;
constexpr double kHot_C = 120.0;
constexpr double kNominalTemperature_C = 30.0;

hal::CanFrame error_frame(std::uint32_t error_class) {
  hal::CanFrame frame;
  frame.id = error_class;
  frame.length = CAN_ERR_DLC;
  frame.error = true;
  return frame;
}

}  // namespace

bool RobotOnBus::active(simulation::FaultKind kind) const {
  return std::ranges::any_of(setup_.faults, [&](const simulation::TimedFault& fault) {
    return fault.kind == kind && fault.active(fault_clock_s_);
  });
}

void RobotOnBus::inject_faults(std::int64_t now_ns) {
  fault_clock_s_ = clock_s();
  for (std::size_t i = 0; i < setup_.faults.size(); ++i) {
    const simulation::TimedFault& fault = setup_.faults[i];
    const bool active_now = fault.active(fault_clock_s_);
    if (active_now == fault_active_[i]) continue;
    fault_active_[i] = active_now;
    if (active_now) {
      injected_.push_back({simulation::describe(fault.kind).name, time_s()});
      begin_fault(now_ns, fault);
    } else {
      end_fault(now_ns, fault);
    }
  }
}

template <class Action>
void RobotOnBus::for_each_driver(const simulation::TimedFault& fault, Action&& action) {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (fault.affects(drivers_.bus(joint), joint)) action(drivers_.driver(joint));
  }
}

void RobotOnBus::begin_fault(std::int64_t now_ns, const simulation::TimedFault& fault) {
  using Driver = hal::EmulatedDriver;
  switch (fault.kind) {
    case simulation::FaultKind::bus_off:
      set_bus_off(now_ns, *fault.bus, true);
      break;
    case simulation::FaultKind::disconnect:
      bus_gone_[*fault.bus] = true;
      break;
    case simulation::FaultKind::driver_fault:
      for_each_driver(fault, [](Driver& driver) { driver.raise(hal::DriverFault::over_current); });
      break;
    case simulation::FaultKind::encoder_freeze:
      for_each_driver(fault, [](Driver& driver) { driver.freeze_encoder(true); });
      break;
    case simulation::FaultKind::torque_loss:
      for_each_driver(fault, [](Driver& driver) { driver.lose_torque(true); });
      break;
    case simulation::FaultKind::power_cycle:
      for_each_driver(fault, [](Driver& driver) { driver.set_powered(false); });
      break;
    case simulation::FaultKind::low_voltage:
      lower_supply(fault);
      break;
    case simulation::FaultKind::over_temperature:
      for_each_driver(fault, [](Driver& driver) { driver.motor.temperature_C = kHot_C; });
      break;
    default:  // faults of frames, torso sensor and switch are evaluated while they are active
      break;
  }
}

void RobotOnBus::end_fault(std::int64_t now_ns, const simulation::TimedFault& fault) {
  using Driver = hal::EmulatedDriver;
  switch (fault.kind) {
    case simulation::FaultKind::bus_off:
      set_bus_off(now_ns, *fault.bus, false);
      break;
    case simulation::FaultKind::disconnect:
      bus_gone_[*fault.bus] = false;
      break;
    case simulation::FaultKind::encoder_freeze:
      for_each_driver(fault, [](Driver& driver) { driver.freeze_encoder(false); });
      break;
    case simulation::FaultKind::torque_loss:
      for_each_driver(fault, [](Driver& driver) { driver.lose_torque(false); });
      break;
    case simulation::FaultKind::power_cycle:
      for_each_driver(fault, [](Driver& driver) {
        driver.set_powered(true);
        driver.power_cycle();
      });
      break;
    case simulation::FaultKind::low_voltage:
      for_each_driver(fault, [](Driver& driver) { driver.motor.supply_V = kNominalSupply_V; });
      break;
    case simulation::FaultKind::over_temperature:
      for_each_driver(fault, [](Driver& driver) { driver.motor.temperature_C = kNominalTemperature_C; });
      break;
    default:
      break;
  }
}

/// Drivers that measure their supply voltage report it; the others coast with an under-voltage fault.
void RobotOnBus::lower_supply(const simulation::TimedFault& fault) {
  for_each_driver(fault, [](hal::EmulatedDriver& driver) {
    driver.motor.supply_V = kLowSupply_V;
    if (!driver.reports_supply()) driver.raise(hal::DriverFault::under_voltage);
  });
}

/// In bus-off no frame passes in either direction, except the error frames of the CAN controller.
void RobotOnBus::set_bus_off(std::int64_t now_ns, std::size_t bus, bool off) {
  bus_off_[bus] = off;
  line_.send(-1.0, now_ns, {bus, std::nullopt}, error_frame(off ? CAN_ERR_BUSOFF : CAN_ERR_RESTARTED));
}

}  // namespace stilt::robot_on_bus
