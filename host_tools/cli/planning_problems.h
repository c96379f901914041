#pragma once

#include <functional>
#include <vector>

#include "host_tools/cli/controller_choice.h"
#include "host_tools/simulation/closed_loop/scenario.h"
#include "host_tools/simulation/plant/plant_options.h"
#include "mpc_core/control/planner_settings.h"

namespace stilt::cli {

/// The planner's inputs in a closed-loop walk that starts standing at time 0.
struct PlanningProblems {
  std::vector<control::PlannerInput> inputs;
  std::size_t lead =
      0;  ///< of the inputs, until the robot walks: to be solved before the others, as on the robot
  bool survived = false;
};

/// Walks the simulated robot under the chosen controller for 3 s, then for `count` plans, and records the
/// planner's inputs. The result is the same each time.
[[nodiscard]] PlanningProblems record_walk(const ControllerChoice& choice, double speed_m_s, int count);

/// Functions called before and after each plan of a walk.
struct PlanObserver {
  std::function<void()> before = [] {};
  std::function<void(const control::PlannerInput&)> after = [](const control::PlannerInput&) {};
};

/// A walk that starts standing at time 0.
struct Walk {
  double speed_m_s = 0.5;
  int plans = 0;
  std::vector<simulation::Push> pushes = {};
  simulation::PlantOptions world = {};
};

/// Walks the simulated robot under `controller`, set up by `choice`. True when the robot did not fall.
[[nodiscard]] bool walk(const ControllerChoice& choice, const Walk& walk,
                        simulation::SimulatedController& controller, const PlanObserver& observer);

}  // namespace stilt::cli
