#pragma once

#include <cstdint>

#include "mpc_core/ocp/violations.h"

namespace stilt::sqp {

/// Why a solve ended.
enum class SolveStatus : std::uint8_t {
  converged,        ///< cost change and violation below tolerance, or the step vanished (taken or not)
  iteration_limit,  ///< used all iterations or backtracking steps; the plan is usable
  step_rejected,    ///< the line search found no acceptable step; the last accepted iterate is the plan
  not_finite,       ///< NaN or infinity in input, linearisation or step: no plan
  not_convex,       ///< a reduced Hessian was not positive definite: no plan
  infeasible,       ///< defects or contact forces exceed those of a usable plan (planner): no plan
};

/// Result of one solve.
struct SolveReport {
  SolveStatus status = SolveStatus::not_finite;
  int iterations = 0;
  int trial_steps = 0;  ///< over all line searches
  double cost = 0.0;
  double dynamics_defect_max = 0.0;     ///< largest |x_{k+1} - F(x_k, u_k)|, mixed SI units
  double equality_violation_max = 0.0;  ///< largest equality residual, m/s^2 or N
  ocp::Violations violations;           ///< of the inequalities, by kind
  double line_search_step = 0.0;        ///< factor of the last iteration's step as it was taken; 0: none was
  double step_component_max = 0.0;      ///< largest component of the last step taken, mixed SI units

  /// True when the plan may be executed.
  [[nodiscard]] constexpr bool usable() const noexcept { return status < SolveStatus::not_finite; }
};

/// Time spent in each phase of a solve, microseconds.
struct PhaseTimes {
  double linearise_us = 0.0;
  double riccati_us = 0.0;
  double line_search_us = 0.0;
  double total_us = 0.0;
};

}  // namespace stilt::sqp
