#pragma once

#include "host_tools/cli/bench_output.h"
#include "host_tools/cli/planning_problems.h"
#include "mpc_core/dispatch/dispatched_planner.h"

namespace stilt::cli {

/// Solves a list of problems in order, as a planner does in a walk, and times each after the lead by the wall
/// clock.
[[nodiscard]] PlannerTimings time_planner(dispatch::DispatchedPlanner& dispatched,
                                          const PlanningProblems& problems);

}  // namespace stilt::cli
