#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "firmware/supervisor/fallback.h"
#include "mpc_core/control/plan.h"
#include "mpc_core/model/types.h"

/// Data of one run of the simulated robot: samples for plots and animation, and the summary that `stilt sim
/// --json` prints.
namespace stilt::log {

/// One sample of plant and controller, every few milliseconds.
struct RunSample {
  double time_s = 0.0;
  model::StateVector true_state;
  model::StateVector estimated_state;
  model::StateVector planned_state;   ///< the active plan at this time
  model::JointVector torque_Nm;       ///< applied by the motors
  model::FeetVector contact_force_N;  ///< measured in the plant: fx_L, fz_L, fx_R, fz_R
  model::FeetVector planned_contact_force_N;
  model::FeetVector foot_position_m;
  model::ContactMode scheduled_mode;
  double push_N = 0.0;            ///< positive is forward
  double push_above_hip_m = 0.0;  ///< distance of its point from the hip along the torso
  double commanded_speed_m_s = 0.0;
};

/// Geometry of a plan, for drawing it ahead of the robot.
struct PlanSnapshot {
  double time_s = 0.0;
  std::vector<double> node_time_s;
  std::vector<double> base_x_m, base_z_m, pitch_rad;
  std::vector<model::FeetVector> foot_position_m;
};

/// One solve of the planner.
struct SolveSample {
  double time_s = 0.0;
  double solve_us = 0.0;
  sqp::SolveReport report;
};

/// One touch-down.
struct Step {
  double time_s = 0.0;    ///< of touch-down
  std::string foot;       ///< "L" or "R"
  double length_m = 0.0;  ///< distance to the other foot, positive when it lands ahead
  double hip_x_m = 0.0;   ///< position of the hip at touch-down
};

struct Percentiles {
  double p50 = 0.0, p99 = 0.0, max = 0.0;
};

/// How well the plans in use hold their constraints: over every plan that drove the robot, its nodes of age 0
/// to 0.3 s, stance feet.
struct PlanInUse {
  double defect_max = 0.0;              ///< largest |x_{k+1} - F(x_k, u_k)|, mixed SI units, whole horizon
  double equality_violation_max = 0.0;  ///< largest equality residual, m/s^2 or N, whole horizon
  double cone_violation_max_N = 0.0;    ///< largest |fx| - mu max(fz, 0), not below 0; mu as planned
  double normal_force_min_N = std::numeric_limits<double>::infinity();  ///< infinite: no plan was in use
};

/// Summary of a run, the content of `stilt sim --json`.
struct RunSummary {
  bool survived = false;
  double fall_time_s = -1.0;     ///< negative when the robot did not fall
  double fall_margin_min = 1.0;  ///< smallest share of the way to a fall that was left, see
                                 ///< Plant::fall_margin(); 1: upright at nominal height
  double duration_s = 0.0, distance_m = 0.0, mean_speed_m_s = 0.0;
  std::vector<Step> steps;
  bool steps_known = true;  ///< whether `steps` has all of them
  double step_length_min_m = 0.0, step_length_max_m = 0.0;
  model::JointVector peak_torque_Nm = model::JointVector::Zero();
  model::JointVector peak_joint_speed_rad_s = model::JointVector::Zero();
  double slip_distance_m = 0.0;  ///< distance that loaded feet slid along the ground
  double saturated_s = 0.0;      ///< time over which a motor was at its torque limit
  Percentiles solve_time_us;
  double sqp_iterations_mean = 0.0;
  int sqp_iterations_max = 0;
  double dynamics_defect_max = 0.0, equality_violation_max = 0.0;
  PlanInUse plan_in_use;
  /// Time at each fallback level, s.
  std::array<double, supervisor::kFallbackLevels> fallback_s{};
  long long heap_allocations_in_loop = 0;
  std::size_t controller_bytes = 0;
};

/// Lengths for drawing the robot.
struct RobotDrawing {
  std::string name;
  double torso_length_m = 0.5, thigh_length_m = 0.4, shin_length_m = 0.4;
};

/// A key of the configuration and its value as text.
struct Setting {
  std::string key, value;
};

/// Something that happened in a run of stiltd.
struct RunEvent {
  double time_s = 0.0;
  std::string text;
};

/// What a record of stiltd has besides samples.
struct ControllerPart {
  std::string last_state;  ///< before it was off
  std::vector<RunEvent> events;
};

/// Ticks of stiltd that a file lacks between others: the first and the last of them.
struct MissingTicks {
  std::uint64_t first = 0, last = 0;
  double from_s = 0.0, to_s = 0.0;
};

/// All data of one run.
struct RunRecord {
  std::string command_line;
  /// Of a record of stiltd: the true state is unknown, and supervisor's states are the outcome.
  std::optional<ControllerPart> controller;
  bool outcome_known = true;      ///< whether the summary says if the robot fell
  std::vector<Setting> settings;  ///< empty: not known
  RobotDrawing robot;
  double torque_limit_Nm[model::kJoints] = {};
  /// The limits that hold: of all, and of plans and torque law where they are less. Empty: torque_limit_Nm.
  std::vector<std::array<double, model::kJoints>> allowed_torque_Nm;
  double friction_coefficient = 0.6;
  /// Profile of the ground for drawing, x ascending; empty: level at z = 0.
  std::vector<double> ground_x_m, ground_z_m;
  std::vector<RunSample> samples;
  std::vector<MissingTicks> missing_ticks;
  std::vector<PlanSnapshot> plans;
  std::vector<SolveSample> solves;
  RunSummary summary;
};

}  // namespace stilt::log
