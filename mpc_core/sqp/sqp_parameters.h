#pragma once

namespace stilt::sqp {

/// Iteration limits and tolerances of the SQP. g, the violation, is the root of the summed squared defects of
/// dynamics and equality constraints.
struct SqpParameters {
  int iterations = 10;
  bool early_stop = true;
  double cost_tolerance = 1e-4;       ///< converged: change of the cost below this ...
  double violation_tolerance = 1e-3;  ///< ... and g below this
  double step_tolerance = 1e-6;       ///< converged: largest component of the step below this
  double step_decrease = 0.5;         ///< backtracking factor
  double step_min = 1e-4;
  double g_max = 1e6;
  double g_min = 1e-6;
  double gamma_c = 1e-6;
  double armijo = 1e-4;
};

}  // namespace stilt::sqp
