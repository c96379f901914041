#include "firmware/program/commissioning_requests.h"

#include <algorithm>

#include "firmware/configuration/hardware.h"

namespace stilt::program {

commissioning::DriverLimits driver_limits(const Options& options) {
  const supervisor::SupervisorParameters& supervisor = options.configuration.supervisor;
  return {.overheated_C = supervisor.overheated_C,
          .low_voltage_V = supervisor.low_voltage_V,
          .high_voltage_V = supervisor.high_voltage_V,
          .stall_s = supervisor.torque_loop_stall_s};
}

commissioning::JogRequest jog_request(const Options& options, const model::RobotModel& robot) {
  const supervisor::SupervisorParameters& supervisor = options.configuration.supervisor;
  return {.joint = options.joint,
          .angle_rad = options.jog_angle_rad,
          .torque_limit_Nm = robot.constants.torque_limit_Nm[options.joint],
          .torque_share = std::min(commissioning::kJogTorqueShare, supervisor.torque_limit_share),
          .push_Nm = commissioning::first_push_Nm(robot, options.joint),
          .kp_Nm_rad = supervisor.hold_kp_Nm_rad,
          .kd_Nms_rad = supervisor.hold_kd_Nms_rad,
          .supervisor = supervisor};
}

std::array<hal::bring_up::Options, hal::kJoints> wanted_of_drivers(const Options& options,
                                                                   const model::RobotModel& robot) {
  const model::RobotConstants& constants = robot.constants;
  std::array<hal::bring_up::Options, hal::kJoints> wanted;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    wanted[joint] = configuration::bring_up_options(
        options.configuration.hardware, joint, constants.position_min_rad[joint],
        constants.position_max_rad[joint], constants.velocity_limit_rad_s[joint]);
  }
  return wanted;
}

commissioning::IdentificationRequest identification_request(const Options& options,
                                                            const model::RobotModel& robot) {
  const supervisor::SupervisorParameters& supervisor = options.configuration.supervisor;
  return {.robot = &robot,
          .torque_share = std::min(options.identify_torque_share, supervisor.torque_limit_share),
          .kp_Nm_rad = supervisor.hold_kp_Nm_rad,
          .supervisor = supervisor,
          .hardware = options.configuration.hardware};
}

}  // namespace stilt::program
