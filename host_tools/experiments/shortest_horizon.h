#pragma once

#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/walk_case.h"

namespace stilt::experiments {

/// With which horizons each predictive controller walks.
struct HorizonPlan {
  std::vector<std::string> controllers = {"mpc-lumped", "mpc-none", "mpc-heuristic", "mpc-hzd"};
  std::vector<double> horizons_s;  ///< ascending
  double duration_s = 60.0;
  double speed_m_s = 0.5;
};

/// 0.10 to 0.60 s in steps of 0.05, then 0.8, 1.0, 1.5 and 2.0 s.
[[nodiscard]] std::vector<double> tried_horizons_s();

/// One job a controller and horizon: {controller, horizon_s, survived, fall_time_s, mean_speed_m_s}.
[[nodiscard]] std::vector<Job> horizon_jobs(const HorizonPlan& plan, const WalkRunner& run);

/// {rows: [{controller, shortest_horizon_s, tried: [...]}]}: the shortest horizon that walks to the end, with
/// every longer one that was tried walking, too; null when the longest one falls.
[[nodiscard]] Json merge_horizons(const HorizonPlan& plan, const std::vector<Json>& results);

/// The rows as a Markdown table.
[[nodiscard]] std::string horizon_table(const Json& merged);

}  // namespace stilt::experiments
