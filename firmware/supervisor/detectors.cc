#include "firmware/supervisor/detectors.h"

#include <algorithm>
#include <cmath>

namespace stilt::supervisor {
namespace {

using hal::JointReading;
using hal::kJoints;

/// False for NaN: a value that must be there and is not is out of bounds.
bool within(double value, double minimum, double maximum) noexcept {
  return value >= minimum && value <= maximum;
}

bool any_joint_missed(const Observation& seen, int ticks) noexcept {
  return std::any_of(seen.joints.begin(), seen.joints.end(), [ticks](const JointReading& joint) {
    return joint.missed_replies >= static_cast<std::uint32_t>(ticks);
  });
}

bool joints_should_move(const Observation& seen, double moving_rad_s) noexcept {
  return std::any_of(seen.planned_speed_rad_s.begin(), seen.planned_speed_rad_s.end(),
                     [moving_rad_s](double speed_rad_s) { return std::abs(speed_rad_s) > moving_rad_s; });
}

bool any_beyond(const hal::JointValues& values, double limit) noexcept {
  return std::any_of(values.begin(), values.end(),
                     [limit](double value) { return !(std::abs(value) <= limit); });
}

bool any_hotter(const Observation& seen, double limit_C) noexcept {
  return std::any_of(seen.joints.begin(), seen.joints.end(), [limit_C](const JointReading& joint) {
    return joint.driver_temperature_C > limit_C || joint.motor_temperature_C > limit_C;
  });
}

}  // namespace

FaultSet detect_limits(const Observation& seen, const JointLimits& limits,
                       const SupervisorParameters& parameters) noexcept {
  FaultSet faults;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const JointReading& joint = seen.joints[i];
    if (joint.time_ns == 0) continue;  // no reply yet: a matter of its replies
    const double speed_rad_s = limits.speed_rad_s[i] + parameters.speed_margin_rad_s;
    faults.add_if(!within(joint.position_rad, limits.position_min_rad[i] - parameters.position_margin_rad,
                          limits.position_max_rad[i] + parameters.position_margin_rad),
                  Fault::joint_position_limit);
    faults.add_if(!within(joint.velocity_rad_s, -speed_rad_s, speed_rad_s), Fault::joint_speed_limit);
    faults.add_if(std::abs(joint.torque_Nm) > limits.torque_Nm[i] + parameters.torque_margin_Nm,
                  Fault::joint_torque_limit);
  }
  faults.add_if(
      !within(seen.base.pitch_rad, -parameters.base_pitch_limit_rad, parameters.base_pitch_limit_rad),
      Fault::base_pitch_limit);
  faults.add_if(!(seen.hip_height_share >= parameters.hip_height_share), Fault::hip_height_limit);
  faults.add_if(any_beyond(seen.signals.following_error_rad, parameters.following_error_rad),
                Fault::following_error);
  return faults;
}

bool encoder_repeats(const JointReading& joint, const SupervisorParameters& parameters) noexcept {
  return joint.unchanged_replies >= static_cast<std::uint32_t>(parameters.unchanged_replies_limit);
}

bool encoder_is_frozen(const JointReading& joint, double planned_speed_rad_s,
                       const SupervisorParameters& parameters) noexcept {
  return std::abs(planned_speed_rad_s) > parameters.moving_rad_s && encoder_repeats(joint, parameters);
}

FaultSet detect_sensors(const Observation& seen, const SupervisorParameters& parameters) noexcept {
  const auto unchanged = static_cast<std::uint32_t>(parameters.unchanged_replies_limit);
  const auto hold = static_cast<std::uint32_t>(parameters.missed_hold_ticks);
  const auto damp = static_cast<std::uint32_t>(parameters.missed_damp_ticks);
  FaultSet faults;
  for (std::size_t i = 0; i < kJoints; ++i) {
    faults.add_if(encoder_is_frozen(seen.joints[i], seen.planned_speed_rad_s[i], parameters),
                  Fault::encoder_frozen);
  }
  faults.add_if(any_beyond(seen.signals.encoder_jump_rad, parameters.encoder_jump_rad), Fault::encoder_jump);
  faults.add_if(!(std::abs(seen.signals.torso_mismatch_rad) <= parameters.torso_mismatch_rad),
                Fault::torso_sensor_implausible);
  const bool repeats =
      seen.base.unchanged_replies >= unchanged && joints_should_move(seen, parameters.moving_rad_s);
  faults.add_if(repeats || seen.base.missed_replies >= damp, Fault::stale_torso_sensor);
  faults.add_if(any_joint_missed(seen, parameters.missed_hold_ticks) || seen.base.missed_replies >= hold,
                Fault::missed_replies);
  faults.add_if(any_joint_missed(seen, parameters.missed_damp_ticks), Fault::lost_replies);
  return faults;
}

double torque_mismatch_limit_Nm(const Signals& signals, std::size_t joint,
                                const SupervisorParameters& parameters) noexcept {
  return std::max(parameters.torque_mismatch_Nm,
                  parameters.torque_mismatch_share * signals.asked_torque_Nm[joint]);
}

bool torque_is_missing(const Signals& signals, std::size_t joint,
                       const SupervisorParameters& parameters) noexcept {
  const double limit_Nm = torque_mismatch_limit_Nm(signals, joint, parameters);
  return !(std::abs(signals.torque_mismatch_Nm[joint]) <= limit_Nm);
}

FaultSet detect_buses(const Observation& seen) noexcept {
  const auto reported = [&seen](hal::JointBusStatus status) {
    return seen.read_status == status || seen.write_status == status;
  };
  FaultSet faults;
  faults.add_if(seen.bus_errors, Fault::bus_error);
  faults.add_if(reported(hal::JointBusStatus::bus_off), Fault::bus_off);
  faults.add_if(reported(hal::JointBusStatus::disconnected), Fault::bus_disconnected);
  return faults;
}

FaultSet detect_drivers(const Observation& seen, const SupervisorParameters& parameters) noexcept {
  FaultSet faults;
  for (const JointReading& joint : seen.joints) {
    faults.add_if(joint.fault != hal::DriverFault::none || joint.state == hal::DriverState::fault,
                  Fault::driver_fault);
    faults.add_if(joint.state == hal::DriverState::idle, Fault::driver_not_enabled);
    faults.add_if(joint.supply_V < parameters.low_voltage_V, Fault::low_voltage);
    faults.add_if(joint.supply_V > parameters.high_voltage_V, Fault::high_voltage);
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    faults.add_if(torque_is_missing(seen.signals, i, parameters), Fault::torque_mismatch);
  }
  faults.add_if(any_hotter(seen, parameters.hot_C), Fault::driver_hot);
  faults.add_if(any_hotter(seen, parameters.overheated_C), Fault::driver_overheated);
  return faults;
}

FaultSet detect_software(const Observation& seen, const SupervisorParameters& parameters) noexcept {
  FaultSet faults;
  const Followable& followable = seen.followable;
  const bool wants_plan = followable.plan == PlanUse::none && !followable.gait_selected;
  faults.add_if(followable.plan == PlanUse::none && !followable.gait, Fault::stale_plan);
  faults.add_if(wants_plan && followable.gait, Fault::plan_missing);
  faults.add_if(wants_plan && seen.plan_age_s > parameters.planner_lost_s, Fault::planner_lost);
  faults.add_if(seen.failed_solves >= parameters.failed_solves, Fault::failed_solves);
  faults.add_if(seen.solve_s > parameters.planner_overrun_s, Fault::planner_overrun);
  faults.add_if(seen.wakeup_latency_s > parameters.torque_loop_overrun_s, Fault::torque_loop_overrun);
  faults.add_if(stall_s(seen) > parameters.torque_loop_stall_s, Fault::torque_loop_stalled);
  faults.add_if(!seen.controller_finite || seen.write_status == hal::JointBusStatus::refused,
                Fault::not_finite);
  return faults;
}

FaultSet detect_operator(const Observation& seen, const SupervisorParameters& parameters) noexcept {
  FaultSet faults;
  const bool silent = !(seen.heartbeat_age_s < parameters.heartbeat_timeout_s);
  faults.add_if(seen.heartbeat_expected && silent, Fault::heartbeat_lost);
  faults.add_if(seen.heartbeat_expected && seen.heartbeat_age_s > parameters.operator_gone_s,
                Fault::operator_gone);
  faults.add_if(seen.emergency_stop == hal::EmergencyStopState::pressed ||
                    seen.emergency_stop == hal::EmergencyStopState::unknown,
                Fault::emergency_stop);
  faults.add_if(seen.bring_up_failed, Fault::bring_up_failed);
  return faults;
}

FaultSet detect(const Observation& seen, const JointLimits& limits,
                const SupervisorParameters& parameters) noexcept {
  return detect_limits(seen, limits, parameters) | detect_sensors(seen, parameters) | detect_buses(seen) |
         detect_drivers(seen, parameters) | detect_software(seen, parameters) |
         detect_operator(seen, parameters);
}

}  // namespace stilt::supervisor
