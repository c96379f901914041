#include "firmware/program/commissioning_requests.h"

#include <algorithm>

namespace stilt::program {

commissioning::JogRequest jog_request(const Options& options, const model::RobotModel& robot) {
  const supervisor::SupervisorParameters& supervisor = options.configuration.supervisor;
  return {.joint = options.jog_joint,
          .angle_rad = options.jog_angle_rad,
          .torque_limit_Nm = robot.constants.torque_limit_Nm[options.jog_joint],
          .torque_share = std::min(commissioning::kJogTorqueShare, supervisor.torque_limit_share),
          .kp_Nm_rad = supervisor.hold_kp_Nm_rad,
          .kd_Nms_rad = supervisor.hold_kd_Nms_rad};
}

commissioning::IdentificationRequest identification_request(const Options& options,
                                                            const model::RobotModel& robot) {
  const supervisor::SupervisorParameters& supervisor = options.configuration.supervisor;
  return {.robot = &robot,
          .torque_share = std::min(options.identify_torque_share, supervisor.torque_limit_share),
          .kp_Nm_rad = supervisor.hold_kp_Nm_rad};
}

}  // namespace stilt::program
