#pragma once

#include <vector>

#include "host_tools/cli/controller_choice.h"
#include "mpc_core/control/planner.h"

namespace stilt::cli {

/// The planner's inputs in a closed-loop walk, from standing still at time 0 on.
struct PlanningProblems {
  std::vector<control::PlannerInput> inputs;
  bool survived = false;
};

/// Walks the simulated robot for `count` plans of its planner and records what the planner was asked. The
/// same each time.
[[nodiscard]] PlanningProblems record_walk(const std::string& robot,
                                           const control::ControllerParameters& parameters, double speed_m_s,
                                           int count);

}  // namespace stilt::cli
