#pragma once

#include "mpc_core/model/types.h"

namespace stilt::ocp {

/// Relaxed logarithmic barrier: B(h) = -weight ln h for h > width, its quadratic continuation below. The
/// weight is in 1/s, as the running cost is; that of the impulse counts once per touch-down and has no unit.
struct BarrierParameters {
  double weight = 0.1;
  double width = 0.1;  ///< h below which it is quadratic, in the unit of the constrained quantity
};

/// Diagonal weights of 1/2 (e_x' Q e_x + e_u' R e_u + sum_feet e' W e), the cost per second of horizon. The
/// cost itself has no unit.
struct CostParameters {
  double base_x = 5.0;               ///< 1/(m^2 s)
  double base_z = 3500.0;            ///< 1/(m^2 s)
  double base_pitch = 150.0;         ///< 1/(rad^2 s)
  double joint_position = 5.0;       ///< 1/(rad^2 s)
  double base_vx = 40.0;             ///< s/m^2
  double base_vz = 25.0;             ///< s/m^2
  double base_pitch_rate = 10.0;     ///< s/rad^2
  double joint_velocity = 1.0;       ///< s/rad^2
  double joint_acceleration = 2e-3;  ///< s^3/rad^2
  double contact_force = 4e-3;       ///< 1/(N^2 s)
  double foot_position = 70.0;       ///< 1/(m^2 s)
  double foot_velocity = 12.0;       ///< s/m^2
  double foot_acceleration = 1e-4;   ///< s^3/m^2
  double touchdown_velocity = 1.0;   ///< s^2/m^2, on the horizontal velocity of a foot at touch-down
  double terminal = 1.0;      ///< rho, dimensionless: factor of the LQR cost-to-go at the end of the horizon;
                              ///< 0: none
  bool terminal_feet = true;  ///< whether the running cost of that LQR includes the weights of the feet
};

/// Least normal force of a stance foot by the number of feet on the ground, N; entry 0 is unused.
struct MinimumNormalForce {
  double by_stance_feet[model::kFeet + 1] = {};

  /// A foot alone carries at least `share` of the weight. With both feet on the ground each may be nearly
  /// unloaded, so that the centre of pressure can move between the feet.
  [[nodiscard]] static MinimumNormalForce of(double share, double mass_kg) noexcept {
    constexpr double kBothFeet = 0.1;
    const double alone_N = share * mass_kg * model::kGravity_m_s2;
    return {{0.0, alone_N, kBothFeet * alone_N}};
  }
  [[nodiscard]] double operator()(const model::ContactMode& mode) const noexcept {
    return by_stance_feet[mode.count()];
  }
};

/// Inequality constraints: friction cone of the stance feet and of the impulses at touch-down, and joint
/// limits, each with a barrier.
struct InequalityParameters {
  double friction_coefficient = 0.6;
  double minimum_normal_force_share =
      0.06;  ///< least normal force of a foot alone on the ground, share of the weight
  BarrierParameters friction{8.0, 5.0};          ///< N
  BarrierParameters impulse{0.05, 0.5};          ///< Ns, once per touch-down
  BarrierParameters joint_torque{0.2, 3.0};      ///< Nm
  BarrierParameters joint_position{0.05, 0.05};  ///< rad
  BarrierParameters joint_velocity{0.05, 0.5};   ///< rad/s
};

/// Gains of the equality constraints on the accelerations of the feet.
struct EqualityParameters {
  double stance_kd_1_s = 20.0;   ///< stance foot: a + kd v = 0
  double swing_kp_1_s2 = 200.0;  ///< swing foot, vertical: a - a_ref + kd (v - v_ref) + kp (p - p_ref) = 0
  double swing_kd_1_s = 20.0;
  double rank_tolerance = 1e-3;  ///< a constraint fades when its reduced row has a smaller norm
                                 ///< (projection.h)
};

enum class Integrator { rk2, rk4 };
enum class Transition { identity, impact };

/// Time grid and integration of the planning problem.
struct DiscretisationParameters {
  double time_step_s = 0.015;
  double horizon_s = 1.0;
  double switch_tolerance_s = 1e-6;  ///< a start this long after a switch still contains its touch-down
  double merge_below_s = 0.002;      ///< intervals shorter than this are merged with their neighbour
  Integrator integrator = Integrator::rk2;
  Transition transition = Transition::impact;
};

/// Joint limits used by the planner.
struct JointLimits {
  double position_min_rad[model::kJoints];
  double position_max_rad[model::kJoints];
  double velocity_rad_s[model::kJoints];
  double torque_Nm[model::kJoints];  ///< at standstill
  /// Torque limit lost per unit of joint speed in the direction of the torque:
  ///   tau <= torque_Nm - slope max(v, 0),   -tau <= torque_Nm - slope max(-v, 0).
  double torque_speed_slope_Nms_rad[model::kJoints];
};

}  // namespace stilt::ocp
