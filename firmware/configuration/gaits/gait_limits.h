#pragma once

namespace stilt::gait_files {

/// What a gait has to keep to. Defaults leave room below the robot's own limits for what disturbs it. The
/// ranges of the joints are the robot's.
struct GaitLimits {
  double torque_Nm = 60.0;                  ///< of each joint, either way
  double joint_position_margin_rad = 0.05;  ///< distance to the ends of each joint's range
  double knee_min_rad = 0.3;             ///< bend of each knee: a straight leg is singular, and cannot push
  double joint_speed_rad_s = 8.0;        ///< of each joint, either way
  double pitch_rad = 0.15;               ///< of the torso, either way
  double friction_ratio = 0.5;           ///< |fx| / fz of the stance foot
  double normal_force_min_N = 50.0;      ///< fz of the stance foot
  double impulse_ratio = 0.5;            ///< |x| / z of the impulse at touch-down
  double clearance_m = 0.03;             ///< height of the swing foot in the middle half of the step
  double touchdown_speed_min_m_s = 0.1;  ///< downward speed of the swing foot at touch-down, least
  double touchdown_speed_max_m_s = 0.4;  ///< and most
  double touchdown_slip_m_s = 0.2;       ///< horizontal speed of the swing foot at touch-down, either way
  double return_map = 0.95;              ///< spectral radius of the return map
};

}  // namespace stilt::gait_files
