#pragma once

#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/walk_case.h"

namespace stilt::experiments {

/// Experiment: the horizons with which each predictive controller walks.
struct HorizonPlan {
  std::vector<std::string> controllers = {"mpc-lumped", "mpc-none", "mpc-heuristic", "mpc-hzd"};
  std::vector<double> horizons_s;  ///< ascending
  int seeds = 1;                   ///< 1, 2, ... of the sensor noise
  double duration_s = 60.0;
  gait::GaitCommand command{gait::GaitKind::walk, 0.5};
};

/// 0.10 to 1.00 s in steps of 0.05 s, then 1.5 and 2.0 s.
[[nodiscard]] std::vector<double> tried_horizons_s();

/// One job per controller, horizon and seed: {controller, horizon_s, seed, survived, fall_time_s,
/// mean_speed_m_s, step_length_left_m, step_length_right_m, walks}. Steps are means of the second half, null
/// where the robot falls.
[[nodiscard]] std::vector<Job> horizon_jobs(const HorizonPlan& plan, const WalkRunner& run);

/// Merges the results to {rows: [{controller, shortest_horizon_s, mean_speed_m_s, step_length_left_m,
/// step_length_right_m, commanded_speed_m_s, duration_s, seeds, tried: [{horizon_s, survived, fall_time_s,
/// mean_speed_m_s, step_length_left_m, step_length_right_m, walks}]}]}.
///
/// A tried horizon survives and walks (see walks.h) when every seed does. Its fall_time_s is the earliest
/// one. Its speed and steps are means over the seeds that survive, null without one. shortest_horizon_s is
/// the shortest horizon that walks, such that every longer tried one walks too; null when the longest one
/// does not walk. Speed and steps of a row are those of its shortest horizon.
[[nodiscard]] Json merge_horizons(const HorizonPlan& plan, const std::vector<Json>& results);

/// The rows as a Markdown table.
[[nodiscard]] std::string horizon_table(const Json& merged);

}  // namespace stilt::experiments
