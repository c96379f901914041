#pragma once

#include "mpc_core/lq/riccati.h"
#include "mpc_core/ocp/stage_models.h"
#include "mpc_core/sqp/solve_report.h"
#include "mpc_core/sqp/sqp_parameters.h"

namespace stilt::sqp {

using ocp::ClockFunction;

/// Gauss-Newton sequential quadratic programming by multiple shooting. Each iteration linearises all stages
/// with the equality constraints projected out, and solves the remaining unconstrained LQ problem by one
/// Riccati sweep. It then searches along the step with a filter of cost and violation
///
///   g = sqrt(sum defects^2 + sum (duration * equality residual)^2)
///
/// (the residual of an acceleration constraint, held for an interval, is a velocity: the unit of most
/// defects). A trial step is compared with the current iterate and accepted by the parameters filter_*:
///   g_new > violation_max:              g_new < (1 - margin) g
///   g, g_new < violation_min, downhill: cost_new <= cost + armijo * step * slope
///   otherwise:                          cost_new < cost - margin g  or  g_new < (1 - margin) g
/// Sources: Galliker et al. 2022, section III; Grandia et al. 2022, "Perceptive locomotion through nonlinear
/// model predictive control", appendix B. Fixed memory, no heap, bounded time (iterations, and
/// `backtracking_steps` over all of them): real-time safe.
class Sqp {
 public:
  /// Improves `iterate` in place. Its first state must be the problem's initial state. A full step would move
  /// it there, but the line search does not count the gap and may reject that step.
  [[nodiscard]] SolveReport solve(const ocp::ProblemData& data, const ocp::Problem& problem,
                                  const SqpParameters& parameters, ocp::Trajectory& iterate) noexcept;

  /// Feedback of the last solve at stage k: du = K dx.
  void feedback_gain(int stage, Eigen::Matrix<double, model::kInputs, model::kStates>& gain) const noexcept;

  void set_clock(ClockFunction clock) noexcept {
    clock_ = clock;
    models_.set_clock(clock);
  }
  [[nodiscard]] const PhaseTimes& phase_times() const noexcept { return times_; }

 private:
  enum class Search { accepted, rejected, exhausted };

  [[nodiscard]] bool step(const ocp::ProblemData& data, const ocp::Problem& problem,
                          const ocp::Trajectory& iterate, SolveReport& report) noexcept;
  /// Linearises all stages and computes their gains, from last to first.
  [[nodiscard]] lq::SweepOutcome sweep_backward(const ocp::ProblemData& data, const ocp::Problem& problem,
                                                const ocp::Trajectory& iterate) noexcept;
  [[nodiscard]] Search line_search(const ocp::ProblemData& data, const ocp::Problem& problem,
                                   const SqpParameters& parameters, const ocp::Trajectory& iterate,
                                   ocp::Trajectory& trial, ocp::Merit& merit, SolveReport& report) noexcept;
  /// Writes the trial iterate. Returns the largest component of the step taken.
  double take_step(const ocp::Trajectory& from, double length, int stages,
                   ocp::Trajectory& to) const noexcept;
  [[nodiscard]] long long now_ns() const noexcept { return clock_ != nullptr ? clock_() : 0; }

  ClockFunction clock_ = nullptr;
  PhaseTimes times_;
  double slope_ = 0.0;
  double full_step_component_max_ = 0.0;  ///< largest component of the step before the line search
  ocp::StageModels models_;
  lq::LqGain gains_[ocp::kMaxStages];
  lq::LqStep steps_[ocp::kMaxNodes];
  lq::RiccatiWorkspace workspace_;
  ocp::Trajectory trial_;
};

}  // namespace stilt::sqp
