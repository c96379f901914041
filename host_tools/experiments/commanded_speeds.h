#pragma once

#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/walk_case.h"

namespace stilt::experiments {

/// Experiment: the mean speed of long walks at several commanded speeds.
struct SpeedPlan {
  std::string controller = "mpc-heuristic";
  double horizon_s = 1.0;
  std::vector<double> speeds_m_s = {-0.3, 0.0, 0.3, 0.5, 0.8};
  double duration_s = 60.0;
};

/// One job per speed: {controller, horizon_s, duration_s, speed_m_s, survived, mean_speed_m_s, walks,
/// peak_torque_Nm, heap_allocations_in_loop}. The mean is that of RunSummary, after the start of the walk.
[[nodiscard]] std::vector<Job> speed_jobs(const SpeedPlan& plan, const WalkRunner& run);

/// {rows: [result of each job]}.
[[nodiscard]] Json merge_speeds(const std::vector<Json>& results);

/// The rows as a Markdown table.
[[nodiscard]] std::string speed_table(const Json& merged);

}  // namespace stilt::experiments
