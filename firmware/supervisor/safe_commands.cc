#include "firmware/supervisor/safe_commands.h"

#include <algorithm>
#include <cmath>

namespace stilt::supervisor {

using hal::JointCommand;
using hal::JointCommands;
using hal::JointReadings;
using hal::kJoints;

JointCommands damped(const JointReadings& measured, const JointLimits& limits,
                     const SupervisorParameters& parameters) noexcept {
  JointCommands commands{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double most_Nm = std::min(parameters.damping_torque_Nm, limits.torque_Nm[i]);
    const double speed_rad_s = std::abs(measured[i].velocity_rad_s);
    double kd = parameters.damping_kd_Nms_rad;
    if (std::isfinite(speed_rad_s) && kd * speed_rad_s > most_Nm) kd = most_Nm / speed_rad_s;
    commands[i].position_rad = std::isfinite(measured[i].position_rad) ? measured[i].position_rad : 0;
    commands[i].kd_Nms_rad = kd;
    commands[i].torque_limit_Nm = most_Nm;
  }
  return commands;
}

JointCommands held(const hal::JointValues& pose_rad, double s, const JointLimits& limits,
                   const SupervisorParameters& parameters) noexcept {
  JointCommands commands{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    commands[i].position_rad = pose_rad[i];
    commands[i].kp_Nm_rad = s * parameters.hold_kp_Nm_rad;
    commands[i].kd_Nms_rad = s * parameters.hold_kd_Nms_rad;
    commands[i].torque_limit_Nm = limits.torque_Nm[i];
  }
  return commands;
}

hal::JointValues pose_between_rad(const hal::JointValues& from_rad, const hal::JointValues& to_rad,
                                  double s) noexcept {
  const double t = std::clamp(s, 0.0, 1.0);
  const double share = t * t * (3 - 2 * t);
  hal::JointValues pose_rad;
  for (std::size_t i = 0; i < kJoints; ++i) pose_rad[i] = from_rad[i] + share * (to_rad[i] - from_rad[i]);
  return pose_rad;
}

JointCommands blend_in(const JointCommands& wanted, const hal::JointValues& start_rad, double s,
                       const SupervisorParameters& parameters) noexcept {
  if (s >= 1) return wanted;
  JointCommands commands = wanted;
  for (std::size_t i = 0; i < kJoints; ++i) {
    JointCommand& command = commands[i];
    const double kd = s * wanted[i].kd_Nms_rad;
    const double kd_both = kd + (1 - s) * parameters.damping_kd_Nms_rad;
    command.position_rad = start_rad[i] + s * (wanted[i].position_rad - start_rad[i]);
    command.velocity_rad_s = kd_both > 0 ? wanted[i].velocity_rad_s * kd / kd_both : 0;
    command.torque_Nm *= s;
    command.kp_Nm_rad *= s;
    command.kd_Nms_rad = kd_both;
  }
  return commands;
}

bool finite(const JointCommands& commands) noexcept {
  return std::all_of(commands.begin(), commands.end(), [](const JointCommand& command) {
    return std::isfinite(command.position_rad) && std::isfinite(command.velocity_rad_s) &&
           std::isfinite(command.torque_Nm) && std::isfinite(command.kp_Nm_rad) &&
           std::isfinite(command.kd_Nms_rad) && std::isfinite(command.torque_limit_Nm);
  });
}

JointCommands bounded(const JointCommands& commands, const JointReadings& measured,
                      const JointLimits& limits) noexcept {
  JointCommands result = commands;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double limit_Nm = limits.torque_Nm[i];
    JointCommand& command = result[i];
    command.torque_Nm = std::clamp(command.torque_Nm, -limit_Nm, limit_Nm);
    command.torque_limit_Nm = std::clamp(command.torque_limit_Nm, 0.0, limit_Nm);
    command.kp_Nm_rad = std::max(command.kp_Nm_rad, 0.0);
    command.kd_Nms_rad = std::max(command.kd_Nms_rad, 0.0);
    const double feedback_Nm = command.kp_Nm_rad * (command.position_rad - measured[i].position_rad) +
                               command.kd_Nms_rad * (command.velocity_rad_s - measured[i].velocity_rad_s);
    const double law_Nm = command.torque_Nm + feedback_Nm;
    if (!(std::abs(law_Nm) > limit_Nm)) continue;  // or nothing is measured to judge it by
    const double share = (std::copysign(limit_Nm, law_Nm) - command.torque_Nm) / feedback_Nm;
    command.kp_Nm_rad *= share;
    command.kd_Nms_rad *= share;
  }
  return result;
}

JointLimits derated(const JointLimits& limits, const JointReadings& measured,
                    const SupervisorParameters& parameters) noexcept {
  JointLimits result = limits;
  const double range_C = parameters.overheated_C - parameters.hot_C;
  for (std::size_t i = 0; i < kJoints; ++i) {
    double way = 0.0;  // from hot to overheated
    for (const double temperature_C : {measured[i].driver_temperature_C, measured[i].motor_temperature_C}) {
      if (!(temperature_C > parameters.hot_C)) continue;  // or not reported
      way = std::max(way, range_C > 0 ? std::min((temperature_C - parameters.hot_C) / range_C, 1.0) : 1.0);
    }
    result.torque_Nm[i] *= parameters.torque_limit_share * (1.0 + way * (parameters.hot_torque_share - 1.0));
  }
  return result;
}

hal::JointValues measured_pose_rad(const JointReadings& measured,
                                   const hal::JointValues& before_rad) noexcept {
  hal::JointValues pose_rad = before_rad;
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (std::isfinite(measured[i].position_rad)) pose_rad[i] = measured[i].position_rad;
  }
  return pose_rad;
}

}  // namespace stilt::supervisor
