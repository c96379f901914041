#pragma once

#include "mpc_core/gait/parameters.h"
#include "mpc_core/ocp/parameters.h"
#include "mpc_core/sqp/sqp_parameters.h"

namespace stilt::control {

/// Gains of the law: torque = feed-forward + kp (q_plan - q) + kd (v_plan - v) + friction compensation,
/// limited to the drive's torque.
struct TorqueLawParameters {
  double joint_kp_Nm_rad = 100.0;
  double joint_kd_Nms_rad = 12.0;
  bool use_feedback_gains = true;  ///< adds a share of the plan's feedback K (x - x_plan) to its inputs
  /// That share grows linearly with the age of the plan, from 0 at the first age to 1 at the second.
  double feedback_from_age_s = 0.008;
  double feedback_full_age_s = 0.016;
  double minimum_normal_force_share = 0.28;  ///< least normal force of a foot alone on the ground, share of
                                             ///< the weight: it stays pressed down
  double friction_compensation = 1.0;     ///< share of the joints' Coulomb friction that is fed forward for
                                          ///< the planned velocity
  double friction_velocity_rad_s = 0.05;  ///< width of the smoothed sign, tanh(v / width)
};

/// Gains of the gait tracker, and the time of its foot placement.
struct GaitTrackerParameters {
  double joint_kp_Nm_rad = 400.0;
  double joint_kd_Nms_rad = 20.0;
  /// Foot placement uses the state this long after touch-down, once the impact has decayed.
  double settle_s = 0.015;
  /// Time over which the joints leave the motion before the gait for the gait's.
  double take_over_s = 0.45;
};

/// Parameters of the base estimator.
struct EstimatorParameters {
  double blend_s = 0.02;  ///< time over which the weight moves from the old stance foot to the new one
  /// Time constant with which the base's velocity follows the measured one around the plan's; 0: no filter.
  double velocity_filter_s = 0.005;
  double velocity_correction_max_m_s2 = 10.0;  ///< largest rate of that correction, of x and z
};

/// Robot parameters that the controller assumes besides the URDF. Friction and damping replace those of the
/// URDF.
struct RobotParameters {
  double armature_scale = 1.0;  ///< factor on the armature of the URDF; 0 plans without it
  double torque_limit_scale = 1.0;
  double velocity_limit_scale = 1.0;
  /// Joint speed at which the drive's torque limit reaches zero; the limit falls linearly up to there. 0: the
  /// limit is constant.
  double no_load_speed_rad_s = 0.0;
  double hip_coulomb_friction_Nm = 0.0;
  double knee_coulomb_friction_Nm = 0.0;
  double hip_damping_Nms_rad = 0.0;
  double knee_damping_Nms_rad = 0.0;
};

/// Rates of the control loop and the planner, and the delay of a plan.
struct TimingParameters {
  double torque_rate_hz = 1000.0;
  double plan_rate_hz = 500.0;
  double plan_delay_s = 0.002;  ///< from the state a plan starts from until it becomes active, simulated
};

/// All tunable parameters. One TOML file per robot sets them (firmware/configuration).
struct ControllerParameters {
  RobotParameters robot;
  gait::GaitParameters gait;
  gait::ReferenceParameters reference;
  ocp::CostParameters cost;
  ocp::InequalityParameters inequality;
  ocp::EqualityParameters equality;
  ocp::DiscretisationParameters discretisation;
  sqp::SqpParameters sqp;
  TorqueLawParameters torque_law;
  GaitTrackerParameters gait_tracker;
  EstimatorParameters estimator;
  TimingParameters timing;
};

}  // namespace stilt::control
