#pragma once

namespace stilt::sqp {

/// Iteration limits and tolerances of the SQP; g is the root of the summed squared defects of dynamics and
/// equality constraints.
struct SqpParameters {
  int iterations = 10;
  bool early_stop = true;
  double cost_tolerance = 1e-4;       ///< ends when the cost changes by less ...
  double violation_tolerance = 1e-3;  ///< ... with g below this
  double step_tolerance = 1e-6;       ///< ends when the largest component of the step is below this
  double step_decrease = 0.5;         ///< backtracking factor
  double step_min = 1e-4;
  double filter_violation_max = 1e6;   ///< above this g only less g is accepted
  double filter_violation_min = 1e-6;  ///< below this g the cost alone decides
  double filter_margin = 1e-6;         ///< least relative decrease of g
  double armijo = 1e-4;                ///< share of the predicted decrease of the cost that is required
};

}  // namespace stilt::sqp
