#pragma once

#include "mpc_core/control/parameters.h"
#include "mpc_core/control/plan.h"
#include "mpc_core/model/robot.h"

namespace stilt::control {

struct PlannerInput {
  double time_s = 0.0;
  model::StateVector state;
  gait::GaitCommand command;
};

/// Where configure() can fail.
enum class ConfigureStatus { ok, horizon_over_capacity, terminal_cost_failed };

/// Time spent in each phase of the last solve, filled when a clock is given to the planner; microseconds.
struct PhaseTimes {
  double linearise_us = 0.0;
  double riccati_us = 0.0;
  double line_search_us = 0.0;
  double total_us = 0.0;
};

}  // namespace stilt::control
