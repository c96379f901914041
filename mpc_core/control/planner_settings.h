#pragma once

#include "mpc_core/control/parameters.h"
#include "mpc_core/gait/command.h"
#include "mpc_core/model/robot.h"
#include "mpc_core/ocp/problem_data.h"
#include "mpc_core/sqp/terminal_cost.h"

namespace stilt::control {

/// Input of one plan.
struct PlannerInput {
  double time_s = 0.0;       ///< time of the state; must not decrease from call to call
  model::StateVector state;  ///< measured or estimated
  gait::GaitCommand command;
  gait::TrackedStep tracked = {};  ///< the schedule keeps in step with it
};

/// Result of configuring a planner.
enum class ConfigureStatus {
  ok,
  horizon_over_capacity,  ///< more intervals or contact switches than the memory holds
  terminal_cost_failed,   ///< the weights admit no stabilising solution of the Riccati equation
  no_such_instructions,   ///< program or processor lacks sqp.instruction_set
};

/// Robot and parameters in the form that a solve uses. 3 kB, owns nothing.
struct PlannerSettings {
  ControllerParameters parameters;
  ocp::ProblemData data;
};

/// Computes the settings. Takes milliseconds, not real-time safe. `settings` is complete only when the result
/// is ok.
[[nodiscard]] ConfigureStatus prepare_settings(const model::RobotModel& robot,
                                               const ControllerParameters& parameters,
                                               sqp::TerminalCostWorkspace& work,
                                               PlannerSettings& settings) noexcept;

}  // namespace stilt::control
