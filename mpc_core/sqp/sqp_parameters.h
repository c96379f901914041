#pragma once

#include "mpc_core/model/instruction_set.h"

namespace stilt::sqp {

/// Iteration limits and tolerances of the SQP, and what the planner accepts of it. g, the violation, is the
/// root of the summed squares of the dynamics' defects, and of the equalities' residuals times the interval's
/// duration.
struct SqpParameters {
  /// Instructions that the planner is compiled for; chosen at start (mpc_core/dispatch).
  model::InstructionSet instruction_set = model::InstructionSet::automatic;
  int iterations = 10;                 ///< largest number
  int backtracking_steps = 20;         ///< largest number in a solve, all line searches together
  bool early_stop = true;              ///< ends when it has converged, or when a line search accepts no step
  double cost_tolerance = 0.1;         ///< converged: change of the cost below this ...
  double violation_tolerance = 0.01;   ///< ... and g below this
  double step_tolerance = 1e-6;        ///< converged: largest component of the step below this
  double step_decrease = 0.5;          ///< backtracking factor
  double step_min = 1e-4;              ///< smallest factor of a step that the line search tries
  double filter_violation_max = 1.0;   ///< above this g only less g is accepted
  double filter_violation_min = 1e-6;  ///< below this g the cost alone decides, where it falls
  double filter_margin = 1e-6;         ///< least decrease of g relative to g, or of the cost per g
  double armijo = 1e-4;                ///< share of the predicted decrease of the cost that is required
  double plan_defect_max = 0.05;       ///< largest defect of a usable plan, mixed SI units
  double plan_cone_violation_max_N = 5.0;  ///< largest violation of the friction cone by a usable plan
  double plan_pulling_force_max_N = 0.0;   ///< largest -f_z of a stance foot of a usable plan
};

}  // namespace stilt::sqp
