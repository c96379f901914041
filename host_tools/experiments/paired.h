#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_tools/experiments/correlation.h"
#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/walk_case.h"

/// Whether one variant of a controller survives less than another, from the same pushes under both.
namespace stilt::experiments {

/// A variant of the controller: rate and delay of its plans, state that it gets, feedback gains.
struct PairedVariant {
  std::string name;
  Json setting;  ///< described, for the figures
};

/// A push, with the runner of each variant.
struct PairedPush {
  std::string name;
  double force_N = 0.0;  ///< positive forward
  std::string point = "hip";
  std::vector<WalkRunner> walk;  ///< in the order of the variants
};

/// A comparison: `to` should survive no less than `from`. Indices of variants.
struct PairedComparison {
  int from = 0, to = 0;
};

struct PairedPlan {
  std::string controller = "mpc-heuristic";
  double horizon_s = 1.0;
  double speed_m_s = 0.5;
  double step_time_s = 0.3;  ///< duration of a step of its gait
  double settled_s = 5.0;    ///< pushes begin after this, within two steps
  double push_duration_s = 1.0;
  double recovery_s = 4.5;  ///< time after the push in which the robot may fall
  int cases = 64;           ///< random phases, each with its own seed of the sensor noise
  std::uint32_t seed = 1;   ///< of phases and noise
  std::vector<PairedVariant> variants;
  std::vector<PairedPush> pushes;
  std::vector<PairedComparison> comparisons;
};

/// Numbers of paired cases.
struct PairedCounts {
  int cases = 0;
  int lost = 0;    ///< survived under `from`, not under `to`
  int gained = 0;  ///< the reverse
};

/// Change of the share that survives, (gained - lost) / cases, with its 95 % interval. With one more pair of
/// each kind, p = (gained + 1) / (cases + 2), q likewise of lost. The interval is p - q +-
/// 1.96 sqrt((p + q - (p - q)^2) / (cases + 2)), of Bonett and Price 2012, eq. 5. `cases` must be positive.
[[nodiscard]] Estimate change_of_share(const PairedCounts& counts);

/// The walk of a case under a push. Phase and noise depend on the seed of the plan, the name of the push and
/// `number` alone: cases of different pushes are independent.
[[nodiscard]] WalkCase paired_walk(const PairedPlan& plan, const PairedPush& push, int number);

/// One job per push and case: {push, case, start_s, seed, survived: {variant: whether}}.
[[nodiscard]] std::vector<Job> paired_jobs(const PairedPlan& plan);

// clang-format off
/// Merges the results of the jobs.
///
/// controller, horizon_s, speed_m_s, cases, seed
/// variants     [{name, setting}]
/// rows         [{push, force_N, point, survived: {variant: number}}]
/// comparisons  [{from, to, cases, lost, gained, change: {value, low, high}, worse}] over all pushes; worse: the
///              whole interval is negative
// clang-format on
[[nodiscard]] Json merge_paired(const PairedPlan& plan, const std::vector<Json>& results);

/// Both tables of a merged experiment, for the terminal.
[[nodiscard]] std::string paired_table(const Json& merged);

}  // namespace stilt::experiments
