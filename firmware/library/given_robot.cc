#include "firmware/library/given_robot.h"

#include <cmath>

namespace stilt::library {
namespace {

/// A driver's reply with an age: what did not come keeps its values and is counted.
bool age(hal::JointReading& reading, bool came, bool same) noexcept {
  reading.missed_replies = came ? 0 : reading.missed_replies + 1;
  if (came) reading.unchanged_replies = same ? reading.unchanged_replies + 1 : 0;
  return came;
}

bool finite(const hal::JointCommand& command) noexcept {
  return std::isfinite(command.position_rad) && std::isfinite(command.velocity_rad_s) &&
         std::isfinite(command.torque_Nm) && std::isfinite(command.kp_Nm_rad) &&
         std::isfinite(command.kd_Nms_rad) && std::isfinite(command.torque_limit_Nm);
}

}  // namespace

void GivenRobot::give(const Measurements& measurements) noexcept {
  given_ = measurements;
  action_ = DriverAction::none;
}

void GivenRobot::read(std::int64_t now_ns, hal::RobotReadings& readings) noexcept {
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    const JointMeasurement& given = given_.joints[i];
    hal::JointReading& joint = readings.joints[i];
    const bool same =
        given.position_rad == joint.position_rad && given.velocity_rad_s == joint.velocity_rad_s;
    joint.state = given_.drivers_enabled ? hal::DriverState::enabled : hal::DriverState::idle;
    const bool came = std::isfinite(given.position_rad) && std::isfinite(given.velocity_rad_s);
    if (!age(joint, came, same)) continue;
    joint.position_rad = given.position_rad;
    joint.velocity_rad_s = given.velocity_rad_s;
    joint.torque_Nm = given.torque_Nm;
    joint.time_ns = now_ns;
  }
  torso_.begin_read();
  if (std::isfinite(given_.pitch_rate_rad_s)) torso_.set_rate(given_.pitch_rate_rad_s);
  if (std::isfinite(given_.pitch_rad)) {
    torso_.set_pitch(now_ns, given_.pitch_rad);
    torso_.reading().left_foot_force_N = given_.left_foot_force_N;
    torso_.reading().right_foot_force_N = given_.right_foot_force_N;
  }
  torso_.end_read();
  readings.base = torso_.reading();
  readings.status = hal::JointBusStatus::ok;
  readings.emergency_stop =
      given_.emergency_stop ? hal::EmergencyStopState::pressed : hal::EmergencyStopState::released;
}

hal::JointBusStatus GivenRobot::write(const hal::JointCommands& commands) noexcept {
  for (const hal::JointCommand& command : commands) {
    if (!finite(command)) return hal::JointBusStatus::refused;
  }
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    const hal::JointCommand& command = commands[i];
    targets_[i] = {command.position_rad, command.velocity_rad_s, command.torque_Nm,
                   command.kp_Nm_rad,    command.kd_Nms_rad,     command.torque_limit_Nm};
  }
  action_ = DriverAction::targets;
  return hal::JointBusStatus::ok;
}

hal::JointBusStatus GivenRobot::disable() noexcept {
  action_ = DriverAction::disable;
  return hal::JointBusStatus::ok;
}

hal::BringUpProgress GivenRobot::bring_up(std::int64_t /*now_ns*/) noexcept {
  action_ = DriverAction::enable;
  if (!given_.drivers_enabled) return {};
  return {.ready = true, .stage = hal::bring_up::Stage::ready};
}

}  // namespace stilt::library
