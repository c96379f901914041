#pragma once

#include "mpc_core/lq/riccati.h"
#include "mpc_core/ocp/linearise.h"
#include "mpc_core/sqp/solve_report.h"
#include "mpc_core/sqp/sqp_parameters.h"

namespace stilt::solver {

/// Time spent in each phase of a solve; microseconds.
struct PhaseTimes {
  double linearise_us = 0.0;
  double riccati_us = 0.0;
  double line_search_us = 0.0;
  double total_us = 0.0;
};

/// A monotonic clock in nanoseconds, for measurements only: results never depend on it.
using ClockFunction = long long (*)() noexcept;

/// Gauss-Newton sequential quadratic programming by multiple shooting. Each iteration linearises all stages
/// with the equality constraints projected out, solves the remaining unconstrained LQ problem by one Riccati
/// sweep, and searches along the step with a filter of cost and violation
///
///   g = sqrt(sum defects^2 + sum (duration * equality residual)^2)
///
/// (the residual of an acceleration constraint, held for an interval, is a velocity: the unit of most
/// defects). A trial step is accepted, compared with the current iterate, when
///   g_new > g_max:                              g_new < (1 - gamma_c) g
///   g, g_new < g_min and the slope is downhill: cost_new <= cost + armijo * step * slope
///   otherwise:                                  cost_new < cost - gamma_c g  or  g_new < (1 - gamma_c) g
/// Source: Galliker et al. 2022, section III; Grandia et al. 2022, "Perceptive locomotion through nonlinear
/// model predictive control", appendix B. Fixed memory, no heap, bounded time: real-time safe.
class Sqp {
 public:
  /// Improves `iterate` in place. Set its first state to the problem's initial state beforehand: a full step
  /// would move it there, but the line search does not count the gap and may refuse that step.
  [[nodiscard]] SolveReport solve(const ocp::ProblemData& data, const ocp::Problem& problem,
                                  const SqpParameters& parameters, ocp::Trajectory& iterate) noexcept;

  /// Feedback of the last solve at stage k: du = K dx.
  void feedback_gain(int stage, Eigen::Matrix<double, model::kInputs, model::kStates>& gain) const noexcept;

  void set_clock(ClockFunction clock) noexcept { clock_ = clock; }
  [[nodiscard]] const PhaseTimes& phase_times() const noexcept { return times_; }

 private:
  enum class Search { accepted, rejected };

  [[nodiscard]] bool step(const ocp::ProblemData& data, const ocp::Problem& problem,
                          const ocp::Trajectory& iterate, SolveReport& report) noexcept;
  /// Gains of all stages. Batches are linearised when the backward sweep comes to their last stage, so that
  /// it finds their numbers in a near cache, and few Hessians are kept at a time.
  [[nodiscard]] SweepOutcome linearise_and_sweep(const ocp::ProblemData& data, const ocp::Problem& problem,
                                                 const ocp::Trajectory& iterate) noexcept;
  /// Linearises the batch of stage k, and up to kTogether - 1 of its group before it; k is its last stage.
  void linearise_group(const ocp::ProblemData& data, const ocp::Problem& problem,
                       const ocp::Trajectory& iterate, int k) noexcept;
  /// Where the model of a batch of that group goes.
  template <class AnyBatch>
  [[nodiscard]] ocp::BatchModel places(const AnyBatch& batch, int group, int index) noexcept;
  [[nodiscard]] LqSecondOrder* hessians(int group, int batch) noexcept {
    return hessians_[group][batch % ocp::kTogether];
  }
  [[nodiscard]] Search line_search(const ocp::ProblemData& data, const ocp::Problem& problem,
                                   const SqpParameters& parameters, const ocp::Trajectory& iterate,
                                   ocp::Trajectory& trial, ocp::Merit& merit, SolveReport& report) noexcept;
  /// Returns the largest component of the step taken.
  double take_step(const ocp::Trajectory& from, double length, int stages,
                   ocp::Trajectory& to) const noexcept;
  void expand_inputs(int stages) noexcept;
  [[nodiscard]] long long now_ns() const noexcept { return clock_ != nullptr ? clock_() : 0; }

  ClockFunction clock_ = nullptr;
  PhaseTimes times_;
  double slope_ = 0.0;
  double full_step_size_ = 0.0;  ///< largest component of the step before the line search
  LqFirstOrder stages_[ocp::kMaxStages];
  LqSecondOrder hessians_[ocp::kGroups][ocp::kTogether][ocp::kLanes];  ///< of the newest batches
  LqTerminal terminal_;
  LqGain gains_[ocp::kMaxStages];
  LqStep steps_[ocp::kMaxNodes];
  RiccatiWorkspace workspace_;
  ocp::InputProjection projections_[ocp::kMaxStages];
  ocp::LineariseWorkspace linearise_work_;
  int linearised_from_[ocp::kGroups];  ///< first batch of each group that is linearised in this iteration
  alignas(64) double input_steps_[ocp::kMaxStages][model::kInputs];
  ocp::Trajectory trial_;
};

}  // namespace stilt::solver
