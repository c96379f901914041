#include "firmware/supervisor/fault_detail.h"

#include <algorithm>
#include <cmath>

namespace stilt::supervisor {
namespace {

using hal::JointReading;
using hal::kJoints;

/// The first joint for which a number crosses its limit. `crosses` fills value and limit.
template <class Crosses>
FaultDetail of_joint(const Observation& seen, const char* unit, const Crosses& crosses) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    FaultDetail found{.joint = static_cast<int>(i), .unit = unit};
    if (crosses(seen.joints[i], i, found)) return found;
  }
  return {};
}

FaultDetail of_number(double value, double limit, const char* unit) noexcept {
  return {.value = value, .limit = limit, .unit = unit};
}

FaultDetail position_limit(const Observation& seen, const JointLimits& limits, double margin_rad) noexcept {
  return of_joint(seen, "rad", [&](const JointReading& joint, std::size_t i, FaultDetail& found) {
    const double lowest = limits.position_min_rad[i] - margin_rad;
    const double highest = limits.position_max_rad[i] + margin_rad;
    found.value = joint.position_rad;
    found.limit = joint.position_rad < lowest ? lowest : highest;
    return joint.time_ns != 0 && !(joint.position_rad >= lowest && joint.position_rad <= highest);
  });
}

/// The first joint of which a signal is beyond its limit.
FaultDetail beyond(const Observation& seen, const Pose& values, double limit, const char* unit) noexcept {
  return of_joint(seen, unit, [&](const JointReading&, std::size_t i, FaultDetail& found) {
    found.value = values[i];
    found.limit = limit;
    return !(std::abs(values[i]) <= limit);
  });
}

FaultDetail replies(const Observation& seen, int ticks) noexcept {
  const double limit = ticks;
  FaultDetail found =
      of_joint(seen, "ticks", [&](const JointReading& joint, std::size_t, FaultDetail& missed) {
        missed.value = joint.missed_replies;
        missed.limit = limit;
        return missed.value >= limit;
      });
  return found.joint < 0 ? of_number(seen.base.missed_replies, limit, "ticks") : found;
}

FaultDetail driver_fault(const Observation& seen) noexcept {
  return of_joint(seen, "", [](const JointReading& joint, std::size_t, FaultDetail& found) {
    found.driver_fault = joint.fault;
    found.fault_code = joint.fault_code;
    return joint.fault != hal::DriverFault::none || joint.state == hal::DriverState::fault;
  });
}

FaultDetail hotter(const Observation& seen, double limit_C) noexcept {
  return of_joint(seen, "C", [&](const JointReading& joint, std::size_t, FaultDetail& found) {
    const bool motor = !(joint.driver_temperature_C > limit_C);
    found.value = motor ? joint.motor_temperature_C : joint.driver_temperature_C;
    found.limit = limit_C;
    return found.value > limit_C;
  });
}

FaultDetail voltage(const Observation& seen, double limit_V, bool low) noexcept {
  return of_joint(seen, "V", [&](const JointReading& joint, std::size_t, FaultDetail& found) {
    found.value = joint.supply_V;
    found.limit = limit_V;
    return low ? joint.supply_V < limit_V : joint.supply_V > limit_V;
  });
}

}  // namespace

FaultDetail detail(Fault fault, const Observation& seen, const JointLimits& limits,
                   const SupervisorParameters& parameters) noexcept {
  const auto unchanged_limit = static_cast<std::uint32_t>(parameters.unchanged_replies_limit);
  switch (fault) {
    case Fault::joint_position_limit:
      return position_limit(seen, limits, parameters.position_margin_rad);
    case Fault::joint_speed_limit:
      return of_joint(seen, "rad/s", [&](const JointReading& joint, std::size_t i, FaultDetail& found) {
        found.value = joint.velocity_rad_s;
        found.limit = limits.speed_rad_s[i] + parameters.speed_margin_rad_s;
        return joint.time_ns != 0 && !(std::abs(found.value) <= found.limit);
      });
    case Fault::joint_torque_limit:
      return of_joint(seen, "Nm", [&](const JointReading& joint, std::size_t i, FaultDetail& found) {
        found.value = joint.torque_Nm;
        found.limit = limits.torque_Nm[i] + parameters.torque_margin_Nm;
        return std::abs(found.value) > found.limit;
      });
    case Fault::base_angle_limit:
      return of_number(seen.base.pitch_rad, parameters.base_angle_limit_rad, "rad");
    case Fault::hip_height_limit:
      return of_number(seen.hip_height_share, parameters.hip_height_share, "of the leg");
    case Fault::following_error:
      return beyond(seen, seen.signals.following_error_rad, parameters.following_error_rad, "rad");
    case Fault::encoder_jump:
      return beyond(seen, seen.signals.encoder_jump_rad, parameters.encoder_jump_rad, "rad");
    case Fault::torso_sensor_implausible:
      return of_number(seen.signals.torso_mismatch_rad, parameters.torso_mismatch_rad, "rad");
    case Fault::torque_mismatch:
      return of_joint(seen, "Nm", [&](const JointReading&, std::size_t i, FaultDetail& found) {
        found.value = seen.signals.torque_mismatch_Nm[i];
        found.limit = torque_mismatch_limit_Nm(seen.signals, i, parameters);
        return torque_is_missing(seen.signals, i, parameters);
      });
    case Fault::encoder_frozen:
      return of_joint(seen, "ticks", [&](const JointReading& joint, std::size_t i, FaultDetail& found) {
        found.value = joint.unchanged_replies;
        found.limit = unchanged_limit;
        return std::abs(seen.planned_speed_rad_s[i]) > parameters.moving_rad_s &&
               joint.unchanged_replies >= unchanged_limit;
      });
    case Fault::stale_torso_sensor:
      return of_number(std::max(seen.base.missed_replies, seen.base.unchanged_replies),
                       parameters.missed_damp_ticks, "ticks");
    case Fault::missed_replies:
      return replies(seen, parameters.missed_hold_ticks);
    case Fault::lost_replies:
      return replies(seen, parameters.missed_damp_ticks);
    case Fault::driver_fault:
      return driver_fault(seen);
    case Fault::driver_not_enabled:
      return of_joint(seen, "", [](const JointReading& joint, std::size_t, FaultDetail&) {
        return joint.state == hal::DriverState::idle;
      });
    case Fault::driver_hot:
      return hotter(seen, parameters.hot_C);
    case Fault::driver_overheated:
      return hotter(seen, parameters.overheated_C);
    case Fault::low_voltage:
      return voltage(seen, parameters.low_voltage_V, true);
    case Fault::high_voltage:
      return voltage(seen, parameters.high_voltage_V, false);
    case Fault::failed_solves:
      return of_number(seen.failed_solves, parameters.failed_solves, "solves");
    case Fault::planner_overrun:
      return of_number(seen.solve_s, parameters.planner_overrun_s, "s");
    case Fault::torque_loop_overrun:
      return of_number(seen.wakeup_latency_s, parameters.torque_loop_overrun_s, "s");
    case Fault::torque_loop_stalled:
      return of_number(stall_s(seen), parameters.torque_loop_stall_s, "s");
    case Fault::heartbeat_lost:
      return of_number(seen.heartbeat_age_s, parameters.heartbeat_timeout_s, "s");
    case Fault::operator_gone:
      return of_number(seen.heartbeat_age_s, parameters.operator_gone_s, "s");
    case Fault::planner_lost:
      return of_number(seen.plan_age_s, parameters.planner_lost_s, "s");
    case Fault::bus_error:
    case Fault::bus_off:
    case Fault::bus_disconnected:
    case Fault::stale_plan:
    case Fault::not_finite:
    case Fault::emergency_stop:
    case Fault::bring_up_failed:
    case Fault::plan_missing:
      break;
  }
  return {};
}

}  // namespace stilt::supervisor
