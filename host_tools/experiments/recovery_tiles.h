#pragma once

#include <optional>
#include <string>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/recording/run_record.h"
#include "host_tools/web/plot/svg_plot.h"

namespace stilt::experiments {

/// The push of a walk, and its recovery.
struct PushedWalk {
  double force_N = 0.0;
  double start_s = 0.0, end_s = 0.0;  ///< of the push
  std::optional<int> recovery_steps;  ///< number of steps after the push (steps.h); nothing: no recovery
};

/// The touch-downs of a recovery as tiles, at most 16. Each is a posture at a touch-down. The first is the
/// last one before the push. The last is the one at which the walk has recovered, or that at the end of the
/// run. Below each is the step length in m, above it the time from the start of the push in s. Both are
/// highlighted during the push. Needs samples.
[[nodiscard]] plot::Plot recovery_tiles(const log::RunRecord& record, const PushedWalk& push,
                                        const std::string& title);

/// The data of the tiles: {force_N, survived, recovery_steps, steps: [{time_s, foot, length_m, pushed}]}.
[[nodiscard]] Json recovery_json(const log::RunRecord& record, const PushedWalk& push);

}  // namespace stilt::experiments
