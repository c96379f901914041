#pragma once

#include "firmware/supervisor/detectors.h"
#include "tests/firmware/supervisor/printers.h"

/// What a healthy robot shows, for tests to spoil.
namespace stilt::supervisor::testing {

inline constexpr std::int64_t kTick_ns = 1'000'000;

[[nodiscard]] inline JointLimits joint_limits() {
  return {.position_min_rad = {-1.6, 0.0, -1.6, 0.0},
          .position_max_rad = {1.6, 2.4, 1.6, 2.4},
          .speed_rad_s = {10, 10, 10, 10},
          .torque_Nm = {80, 80, 80, 80}};
}

[[nodiscard]] inline Observation healthy() {
  Observation seen;
  seen.time_ns = 1'000 * kTick_ns;
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    hal::JointReading& joint = seen.joints[i];
    joint.position_rad = i % 2 == 0 ? -0.2 : 0.4;
    joint.velocity_rad_s = 0.1;
    joint.torque_Nm = 5;
    joint.driver_temperature_C = 40;
    joint.motor_temperature_C = 45;
    joint.supply_V = 48;
    joint.time_ns = seen.time_ns;
    joint.state = hal::DriverState::enabled;
  }
  seen.base.pitch_rad = 0.05;
  seen.base.pitch_rate_rad_s = 0.1;
  seen.base.time_ns = seen.time_ns;
  seen.emergency_stop = hal::EmergencyStopState::released;
  seen.followable.plan = PlanUse::as_it_is;
  return seen;
}

}  // namespace stilt::supervisor::testing
