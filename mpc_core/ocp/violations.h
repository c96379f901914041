#pragma once

namespace stilt::ocp {

/// Largest violation of each kind of inequality over a horizon. 0: it holds in every interval and at every
/// touch-down, or the solve ended before anything was computed. Position and velocity are those at the start
/// of an interval: the measured state counts, the last one does not. The barriers are soft, so that a plan
/// may leave its limits. The least normal force and the margins of the torque law are not counted here, only
/// what the ground and the drives cannot give.
struct Violations {
  double friction_cone_violation_max_N = 0.0;  ///< |f_x| - mu max(f_z, 0) of a stance foot
  double pulling_force_max_N = 0.0;            ///< -f_z of a stance foot
  double impulse_cone_violation_max_Ns = 0.0;  ///< |L_x| - mu L_z of a foot in the new contact mode
  double torque_violation_max_Nm = 0.0;        ///< beyond the drive's limit at that speed
  double position_violation_max_rad = 0.0;     ///< beyond the travel
  double velocity_violation_max_rad_s = 0.0;   ///< beyond the limit
};

}  // namespace stilt::ocp
