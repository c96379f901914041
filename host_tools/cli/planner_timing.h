#pragma once

#include <vector>

#include "host_tools/cli/bench_output.h"
#include "mpc_core/dispatch/dispatched_planner.h"

namespace stilt::cli {

/// Solves a list of problems in order, as a planner does in a walk, and times each by the wall clock.
[[nodiscard]] PlannerTimings time_planner(dispatch::DispatchedPlanner& dispatched,
                                          const std::vector<control::PlannerInput>& inputs);

}  // namespace stilt::cli
