#pragma once

#include <functional>
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

/// What is done around each plan of a walk.
struct PlanObserver {
  std::function<void()> before = [] {};
  std::function<void(const control::PlannerInput&, const solver::SolveReport&)> after =
      [](const control::PlannerInput&, const solver::SolveReport&) {};
};

/// Walks the simulated robot under `controller`, configured with the same parameters, for `count` plans of
/// its planner, from standing still at time 0 on. True when the robot did not fall.
[[nodiscard]] bool walk(const std::string& robot, const control::ControllerParameters& parameters,
                        double speed_m_s, int count, simulator::Controller& controller,
                        const PlanObserver& observer);

}  // namespace stilt::cli
