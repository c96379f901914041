#include "firmware/supervisor/fault_detail.h"

#include <algorithm>
#include <bit>
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
FaultDetail beyond(const Observation& seen, const hal::JointValues& values, double limit,
                   const char* unit) noexcept {
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
  if (found.joint >= 0) return found;
  found = of_number(seen.base.missed_replies, limit, "ticks");
  found.condition = "torso sensor";
  return found;
}

/// The first bus of a set of bits.
FaultDetail of_bus(std::uint8_t buses) noexcept { return {.bus = buses == 0 ? -1 : std::countr_zero(buses)}; }

/// A bus with errors, or else a joint whose frames cannot be decoded.
FaultDetail bus_error(const Observation& seen) noexcept {
  if (seen.buses.erring != 0) return of_bus(seen.buses.erring);
  FaultDetail found = of_bus(0);
  found.condition = "frames that cannot be decoded";
  return found;
}

FaultDetail torso_sensor(const Observation& seen, const SupervisorParameters& parameters) noexcept {
  const bool silent = seen.base.missed_replies >= static_cast<std::uint32_t>(parameters.missed_damp_ticks);
  FaultDetail found =
      silent ? of_number(seen.base.missed_replies, parameters.missed_damp_ticks, "ticks")
             : of_number(seen.base.unchanged_replies, parameters.unchanged_replies_limit, "ticks");
  found.condition = silent ? "silent" : "repeats one value";
  return found;
}

/// A plan that is recent enough is missing because it is not in step with the robot.
FaultDetail missing_plan(const Observation& seen, const SupervisorParameters& parameters) noexcept {
  if (!(seen.plan_age_s < parameters.stale_plan_s))
    return of_number(seen.plan_age_s, parameters.stale_plan_s, "s");
  return {.condition = "not in step"};
}

FaultDetail not_finite(const Observation& seen) noexcept {
  if (seen.write_status == hal::JointBusStatus::refused) return {.condition = "command refused"};
  FaultDetail found = of_joint(seen, "", [](const JointReading& joint, std::size_t, FaultDetail& reading) {
    reading.condition = "reading not a number";
    return !std::isfinite(joint.position_rad) || !std::isfinite(joint.velocity_rad_s);
  });
  if (found.joint >= 0) return found;
  const bool torso = !std::isfinite(seen.base.pitch_rad) || !std::isfinite(seen.base.pitch_rate_rad_s);
  return {.condition = torso ? "torso sensor not a number" : "estimate or torque not a number"};
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
    found.condition = motor ? "motor" : "driver";
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
    case Fault::base_pitch_limit:
      return of_number(seen.base.pitch_rad, parameters.base_pitch_limit_rad, "rad");
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
        found.limit = parameters.unchanged_replies_limit;
        return encoder_is_frozen(joint, seen.planned_speed_rad_s[i], parameters);
      });
    case Fault::stale_torso_sensor:
      return torso_sensor(seen, parameters);
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
      return bus_error(seen);
    case Fault::bus_off:
      return of_bus(seen.buses.off);
    case Fault::bus_disconnected:
      return of_bus(seen.buses.gone);
    case Fault::stale_plan:
    case Fault::plan_missing:
      return missing_plan(seen, parameters);
    case Fault::not_finite:
      return not_finite(seen);
    case Fault::emergency_stop:
      return {.condition = seen.emergency_stop == hal::EmergencyStopState::pressed ? "pressed" : "silent"};
    case Fault::bring_up_failed:  // of the bring-up, which is not observed here
      break;
  }
  return {};
}

}  // namespace stilt::supervisor
