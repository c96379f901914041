#pragma once

#include <algorithm>

#include "firmware/configuration/gaits/gait_limits.h"
#include "mpc_core/model/robot.h"

namespace stilt::gait_synthesis {

/// Ranges of the joints, and their largest torque and speed in a gait, either way: stance hip, stance knee,
/// swing hip, swing knee.
struct JointBounds {
  double position_min_rad[model::kJoints];
  double position_max_rad[model::kJoints];
  double torque_Nm[model::kJoints];
  double speed_rad_s[model::kJoints];
};

/// The bounds of a gait: its limits, and those of the robot's joints and drives. The legs take turns, so that
/// the narrower range and the weaker drive decide. A limit that is not a number stays one.
[[nodiscard]] inline JointBounds joint_bounds(const model::RobotConstants& robot,
                                              const gait_files::GaitLimits& limits) {
  JointBounds bounds{};
  for (int j = 0; j < model::kJoints; ++j) {
    const int other = (j + 2) % model::kJoints;
    bounds.position_min_rad[j] = std::max(robot.position_min_rad[j], robot.position_min_rad[other]);
    bounds.position_max_rad[j] = std::min(robot.position_max_rad[j], robot.position_max_rad[other]);
    bounds.torque_Nm[j] =
        std::min({limits.torque_Nm, robot.torque_limit_Nm[j], robot.torque_limit_Nm[other]});
    bounds.speed_rad_s[j] = std::min(
        {limits.joint_speed_rad_s, robot.velocity_limit_rad_s[j], robot.velocity_limit_rad_s[other]});
  }
  return bounds;
}

}  // namespace stilt::gait_synthesis
