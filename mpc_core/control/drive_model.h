#pragma once

#include <algorithm>

#include "mpc_core/control/parameters.h"
#include "mpc_core/model/robot.h"

namespace stilt::control {

/// The controller's model of the joint drives. Armature and torque limit are the URDF's, scaled by the
/// configuration. Friction and damping are the configuration's, in place of the URDF's. Joints in the order
/// hip_L, knee_L, hip_R, knee_R. Real-time safe.
struct DriveModel {
  double joint_parameters[2 * model::kJoints];  ///< armature (4) kg m^2, damping (4) Nm s/rad
  double coulomb_friction_Nm[model::kJoints];
  double torque_limit_Nm[model::kJoints];  ///< at standstill
  /// Torque limit lost per unit of joint speed in the direction of the torque; 0: constant limit.
  double torque_speed_slope_Nms_rad[model::kJoints];

  /// The torque, clamped to what the drive can give at a velocity. Then |tau| <= limit - slope |v| while it
  /// drives the motion, |tau| <= limit while it brakes. A NaN velocity counts as 0.
  [[nodiscard]] double limited_torque_Nm(int joint, double torque_Nm, double velocity_rad_s) const noexcept {
    const double limit_Nm = torque_limit_Nm[joint];
    const double slope = torque_speed_slope_Nms_rad[joint];
    const double forward_rad_s = velocity_rad_s > 0.0 ? velocity_rad_s : 0.0;
    const double backward_rad_s = velocity_rad_s < 0.0 ? -velocity_rad_s : 0.0;
    return std::clamp(torque_Nm, -std::max(0.0, limit_Nm - slope * backward_rad_s),
                      std::max(0.0, limit_Nm - slope * forward_rad_s));
  }
};

/// The drive model of a robot under the parameters. Real-time safe.
[[nodiscard]] inline DriveModel drive_model(const model::RobotConstants& robot,
                                            const RobotParameters& parameters) noexcept {
  DriveModel drive{};
  for (int j = 0; j < model::kJoints; ++j) {
    const bool hip = j % 2 == 0;
    drive.joint_parameters[j] = parameters.armature_scale * robot.joint_parameters[j];
    drive.joint_parameters[model::kJoints + j] =
        hip ? parameters.hip_damping_Nms_rad : parameters.knee_damping_Nms_rad;
    drive.coulomb_friction_Nm[j] =
        hip ? parameters.hip_coulomb_friction_Nm : parameters.knee_coulomb_friction_Nm;
    drive.torque_limit_Nm[j] = parameters.torque_limit_scale * robot.torque_limit_Nm[j];
    if (parameters.no_load_speed_rad_s > 0.0) {
      drive.torque_speed_slope_Nms_rad[j] = drive.torque_limit_Nm[j] / parameters.no_load_speed_rad_s;
    }
  }
  return drive;
}

}  // namespace stilt::control
