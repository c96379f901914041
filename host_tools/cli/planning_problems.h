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

/// Walks the simulated robot under the chosen controller for `count` plans of its planner and records the
/// planner's inputs. The same each time.
[[nodiscard]] PlanningProblems record_walk(const ControllerChoice& choice, double speed_m_s, int count);

/// Called around each plan of a walk.
struct PlanObserver {
  std::function<void()> before = [] {};
  std::function<void(const control::PlannerInput&)> after = [](const control::PlannerInput&) {};
};

/// Walks the simulated robot under `controller`, set up by `choice`, for `count` plans of its planner, from
/// standing still at time 0 on. True when the robot did not fall.
[[nodiscard]] bool walk(const ControllerChoice& choice, double speed_m_s, int count,
                        simulation::SimulatedController& controller, const PlanObserver& observer);

}  // namespace stilt::cli
