#pragma once

#include <algorithm>

#include "hal/robot/joint_bus.h"

namespace stilt::supervisor {

/// Limits of the supervisor and the gains of what it does itself. Joint limits are those of the robot's URDF;
/// here are the margins beyond them.
struct SupervisorParameters {
  double torque_limit_share = 1.0;     ///< of the joints' torque limits, at every level
  double plan_torque_share = 1.0;      ///< of the joints' torque limits, in plans; robot.torque_limit_scale
  double walk_torque_share = 0.6;      ///< smaller shares of torque only stand
  double position_margin_rad = 0.15;   ///< travel beyond the URDF's before joint_position_limit
  double speed_margin_rad_s = 8.0;     ///< speed beyond the URDF's before joint_speed_limit
  double torque_margin_Nm = 20.0;      ///< reported torque beyond the URDF's before joint_torque_limit
  double base_pitch_limit_rad = 0.8;   ///< pitch of the torso, either way
  double hip_height_share = 0.5;       ///< hip above the lower foot, of the straight leg
  double following_error_rad = 0.8;    ///< joint from where it should be, mean of 0.05 s
  double encoder_jump_rad = 0.05;      ///< between two replies, beyond what the joint's rate explains
  double torso_mismatch_rad = 0.05;    ///< of pitch and the integral of its rate, over 0.2 s
  double torque_mismatch_Nm = 10.0;    ///< of reported and asked torque, mean of 0.2 s
  double torque_mismatch_share = 0.6;  ///< and of the asked torque: a motor at speed gives less, too
  int unchanged_replies_limit = 25;    ///< equal values in a row of something that must move
  double moving_rad_s = 0.5;      ///< a joint that is planned to be faster must move, and the base with it
  int missed_hold_ticks = 3;      ///< missed replies in a row before the pose is held
  int missed_damp_ticks = 10;     ///< missed replies in a row before the joints are damped
  double settle_s = 0.05;         ///< after the drivers came up, before their states count
  double hot_C = 75.0;            ///< driver or motor, warning
  double overheated_C = 90.0;     ///< driver or motor, sit down
  double hot_torque_share = 0.7;  ///< of the torque limit just below overheated_C; 1 up to hot_C
  double low_voltage_V = 36.0;    ///< supply
  double high_voltage_V = 56.0;   ///< supply
  double plan_feedback_after_s = 0.1;   ///< age of a plan from which the level is plan_feedback
  double stale_plan_s = 0.25;           ///< age from which a plan is followed to its next touch-down at most
  bool track_gait = true;               ///< without a plan, where gaits of the robot are known
  bool select_gait = false;             ///< prefer the gait to plans, from a touch-down on
  double select_gait_after_s = 2.0;     ///< not before the robot has stepped for so long
  int failed_solves = 3;                ///< in a row, warning
  double planner_overrun_s = 0.010;     ///< time of one solve, warning
  double torque_loop_overrun_s = 5e-4;  ///< wake-up latency of a tick, warning
  double torque_loop_stall_s =
      0.010;                     ///< between two ticks, or wake-up latency of one, before joints are damped
  double planner_lost_s = 10.0;  ///< age of the newest plan at which a robot on a gait sits
  double heartbeat_timeout_s = 0.4;    ///< silence of the operator's program
  double operator_gone_s = 30.0;       ///< silence of the operator's program before the robot sits
  double emergency_stop_wait_s = 1.0;  ///< after the start, for the emergency stop's first report
  double damped_before_off_s = 3.0;    ///< damped before the motors are off: emergency stop, end, reset
  double stand_pose_margin_rad = 0.2;  ///< joints and torso off the standing pose, at most, to stand up
  double stand_speed_rad_s = 1.0;      ///< speed of joints and torso, at most, to stand up
  double stance_margin_rad = 0.5;      ///< while it stands up: farther off, the attempt ends
  double stand_wait_s = 60.0;          ///< for that pose, before a stand that was asked for is void
  double torque_blend_s = 0.02;        ///< over which a jump of torque at a change of level or gains fades
  double stand_ramp_s = 1.5;           ///< time over which the torque law is blended in when standing up
  double slow_down_s = 1.5;            ///< stepping in place between walking and standing
  double reset_window_s = 0.5;         ///< after a reset was asked for: time for every cause to be gone
  double hold_kp_Nm_rad = 100.0;       ///< holding and sitting
  double hold_kd_Nms_rad = 4.5;        ///< holding and sitting
  double hold_ramp_s = 0.05;           ///< from nothing to these gains
  double damping_kd_Nms_rad = 4.5;
  double damping_torque_Nm = 40.0;  ///< most that damping may give, by less gain at high speed
  double sit_s = 2.0;               ///< from the measured pose to the sitting pose
  double sit_hip_rad = -1.1;        ///< of both legs
  double sit_knee_rad = 2.2;        ///< of both legs
};

[[nodiscard]] constexpr hal::JointValues sitting_pose_rad(const SupervisorParameters& parameters) noexcept {
  return {parameters.sit_hip_rad, parameters.sit_knee_rad, parameters.sit_hip_rad, parameters.sit_knee_rad};
}

/// Share of the joints' torque limits that a walk has: plans with less torque than walking needs fall, too.
[[nodiscard]] constexpr double torque_share_of_walk(const SupervisorParameters& parameters) noexcept {
  return std::min(parameters.torque_limit_share, parameters.plan_torque_share);
}

/// Whether the torque limits leave enough to step and walk.
[[nodiscard]] constexpr bool may_walk(const SupervisorParameters& parameters) noexcept {
  return torque_share_of_walk(parameters) >= parameters.walk_torque_share;
}

/// The key that keeps the robot from walking, when may_walk() is false.
[[nodiscard]] constexpr const char* key_against_walk(const SupervisorParameters& parameters) noexcept {
  return parameters.torque_limit_share < parameters.walk_torque_share ? "supervisor.torque_limit_share"
                                                                      : "robot.torque_limit_scale";
}

/// What the joints can bear, in the order of Pose.
struct JointLimits {
  hal::JointValues position_min_rad{};
  hal::JointValues position_max_rad{};
  hal::JointValues speed_rad_s{};
  hal::JointValues torque_Nm{};
};

}  // namespace stilt::supervisor
