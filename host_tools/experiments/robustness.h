#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/random_robot.h"
#include "host_tools/experiments/walk_case.h"

/// How many of many random robots stay on their feet, and what those that do not have in common.
namespace stilt::experiments {

struct RobustnessPlan {
  std::string controller = "mpc-heuristic";
  double horizon_s = 1.0;
  double speed_m_s = 0.5;
  double force_N = 40.0;  ///< of the push, positive forward
  PushTiming timing;
  std::uint32_t seed = 1;
  int runs = 500;  ///< robots
  int worst = 10;  ///< number of runs that are listed
  std::vector<RandomQuantity> quantities;
  std::function<std::string(const WalkCase&)> command;  ///< command line that repeats a walk
};

/// The walk of a run's robot. It depends on the seed of the plan and on `run` alone, not on the number of
/// runs.
[[nodiscard]] WalkCase random_walk(const RobustnessPlan& plan, int run);

/// Name of a run, for its job and its page.
[[nodiscard]] std::string run_name(const RobustnessPlan& plan, int run);

/// One job per run: {run, seed, survived, fall_time_s, fall_margin_min, mean_speed_m_s, changes: {quantity:
/// value}, command}.
[[nodiscard]] std::vector<Job> robustness_jobs(const RobustnessPlan& plan, const WalkRunner& run);

// clang-format off
/// Merges the results of the jobs. An estimate is {value, low, high} with the ends of its 95 % interval.
///
/// controller, horizon_s, speed_m_s, force_N, seed
/// runs, survived
/// survival        share of the runs that survived, Wilson's interval
/// quantities      [{name, words, unit, low, high, nominal, falls, margin, distance}], the strongest
///                 correlation first, combined ones included; correlations with a drawn value, null when undefined. falls: of falling, point-biserial; margin: of the
///                 outcome, Spearman's; distance: of the outcome with |value - nominal|, Spearman's, null
///                 when there is no nominal value between the ends. Outcome: fall_margin_min; a fall is less
///                 than every margin, an early fall less than a late one
/// worst           the results of the jobs with the smallest outcomes, ascending, each with `page`, the name
///                 of its file with animation and plots
// clang-format on
[[nodiscard]] Json merge_robustness(const RobustnessPlan& plan, const std::vector<Json>& results);

/// The value of a quantity in the result of a job, drawn or combined.
[[nodiscard]] double value_of(const std::string& quantity, const Json& result);

/// The order of outcomes: fall_margin_min of a run that survived. For a fall it is less than that of any such
/// run, and the less the earlier it was.
[[nodiscard]] double outcome(const Json& result);

/// Survival, the strongest correlations and the worst runs as Markdown.
[[nodiscard]] std::string robustness_table(const Json& merged);

}  // namespace stilt::experiments
