#include "mpc_core/solver/sqp.h"

#include <algorithm>
#include <cmath>

#include "mpc_core/solver/simd_columns.h"

namespace stilt::solver {
namespace {

using model::kInputs;

bool is_finite(const ocp::Merit& merit) noexcept {
  return std::isfinite(merit.cost) && std::isfinite(merit.violation_squared);
}

/// The filter of the class comment.
bool acceptable(const SqpParameters& p, const ocp::Merit& now, const ocp::Merit& trial, double length,
                double slope) noexcept {
  if (!is_finite(trial)) return false;
  const double g = std::sqrt(now.violation_squared);
  const double g_new = std::sqrt(trial.violation_squared);
  if (g_new > p.g_max) return g_new < (1.0 - p.gamma_c) * g;
  if (g < p.g_min && g_new < p.g_min && slope < 0.0)
    return trial.cost <= now.cost + p.armijo * length * slope;
  return trial.cost < now.cost - p.gamma_c * g || g_new < (1.0 - p.gamma_c) * g;
}

}  // namespace

bool Sqp::step(const ocp::ProblemData& data, const ocp::Problem& problem, const ocp::Trajectory& iterate,
               SolveReport& report) noexcept {
  const int stages = problem.horizon.stages;
  const long long start_ns = now_ns();
  ocp::linearise(data, problem, iterate, stages_, projections_, terminal_, linearise_work_);
  const long long linearised_ns = now_ns();
  const SweepStatus sweep = backward_sweep(stages_, stages, terminal_, gains_, workspace_);
  if (!sweep.ok()) {
    report.status = sweep.outcome == SweepOutcome::kNotPositiveDefinite ? SolveStatus::not_convex
                                                                        : SolveStatus::not_finite;
    return false;
  }
  alignas(64) double x0[kRows] = {};
  for (int i = 0; i < kStates; ++i) x0[i] = problem.x_initial[i] - iterate.x[0][i];
  forward_sweep(stages_, stages, gains_, x0, steps_);
  expand_inputs(stages);
  // The inputs also move along u0, onto the equality constraints, which the LQ problem does not see.
  slope_ = cost_slope(stages_, stages, terminal_, steps_);
  for (int k = 0; k < stages; ++k) slope_ += projections_[k].u0_slope;
  const long long end_ns = now_ns();
  times_.linearise_us += 1e-3 * static_cast<double>(linearised_ns - start_ns);
  times_.riccati_us += 1e-3 * static_cast<double>(end_ns - linearised_ns);
  // The sweep checks all but the measured state, which enters here; a bad number in any step spoils the
  // slope.
  if (!std::isfinite(slope_)) {
    report.status = SolveStatus::not_finite;
    return false;
  }
  return true;
}

void Sqp::expand_inputs(int stages) noexcept {
  for (int k = 0; k < stages; ++k) {
    const ocp::InputProjection& projection = projections_[k];
    const LqStage& stage = stages_[k];
    const LqStep& step = steps_[k];
    double du[kInputs];
    std::copy(projection.u0, projection.u0 + kInputs, du);
    const int constraints = stage.form == StageForm::flow ? stage.constraints : 0;
    for (int r = 0; r < constraints; ++r) {
      for (int i = 0; i < kInputs; ++i) du[i] += projection.Y[r][i] * step.c[r];
    }
    for (int c = 0; c < stage.free_inputs; ++c) {
      for (int i = 0; i < kInputs; ++i) du[i] += projection.W[c][i] * step.w[c];
    }
    if (projection.first_force >= 0) {
      for (int axis = 0; axis < 2; ++axis)
        du[projection.first_force + axis] += dot(projection.F[axis], step.x);
    }
    std::copy(du, du + kInputs, input_steps_[k]);
  }
}

double Sqp::step_size(int stages) const noexcept {
  double size = 0.0;
  for (int k = 0; k <= stages; ++k) {
    for (int i = 0; i < kStates; ++i) size = std::max(size, std::abs(steps_[k].x[i]));
  }
  for (int k = 0; k < stages; ++k) {
    for (int i = 0; i < kInputs; ++i) size = std::max(size, std::abs(input_steps_[k][i]));
  }
  return size;
}

Sqp::Search Sqp::line_search(const ocp::ProblemData& data, const ocp::Problem& problem,
                             const SqpParameters& p, ocp::Trajectory& iterate, ocp::Merit& merit,
                             SolveReport& report) noexcept {
  const int stages = problem.horizon.stages;
  const long long start_ns = now_ns();
  Search result = Search::rejected;
  for (double length = 1.0; length >= p.step_min; length *= p.step_decrease) {
    for (int k = 0; k <= stages; ++k) {
      for (int i = 0; i < kRows; ++i) trial_.x[k][i] = iterate.x[k][i] + length * steps_[k].x[i];
    }
    for (int k = 0; k < stages; ++k) {
      for (int i = 0; i < kInputs; ++i) trial_.u[k][i] = iterate.u[k][i] + length * input_steps_[k][i];
    }
    const ocp::Merit trial = ocp::evaluate(data, problem, trial_);
    if (!acceptable(p, merit, trial, length, slope_)) continue;
    std::copy(&trial_.x[0][0], &trial_.x[stages][0] + kRows, &iterate.x[0][0]);
    std::copy(&trial_.u[0][0], &trial_.u[stages][0], &iterate.u[0][0]);
    merit = trial;
    report.step_length = length;
    report.step_size = length * step_size(stages);
    result = Search::accepted;
    break;
  }
  times_.line_search_us += 1e-3 * static_cast<double>(now_ns() - start_ns);
  return result;
}

SolveReport Sqp::solve(const ocp::ProblemData& data, const ocp::Problem& problem, const SqpParameters& p,
                       ocp::Trajectory& iterate) noexcept {
  SolveReport report;
  times_ = PhaseTimes{};
  const long long start_ns = now_ns();
  ocp::Merit merit = ocp::evaluate(data, problem, iterate);
  report.status = is_finite(merit) ? SolveStatus::iteration_limit : SolveStatus::not_finite;
  while (report.status == SolveStatus::iteration_limit && report.iterations < p.iterations) {
    if (!step(data, problem, iterate, report)) break;
    ++report.iterations;
    const double cost_before = merit.cost;
    if (line_search(data, problem, p, iterate, merit, report) == Search::rejected) {
      report.step_length = 0.0;
      if (p.early_stop) report.status = SolveStatus::step_rejected;
      continue;
    }
    const bool settled = std::abs(merit.cost - cost_before) < p.cost_tolerance &&
                         std::sqrt(merit.violation_squared) < p.violation_tolerance;
    if (p.early_stop && (settled || report.step_size < p.step_tolerance))
      report.status = SolveStatus::converged;
  }
  report.cost = merit.cost;
  report.dynamics_defect_max = merit.defect_max;
  report.equality_violation_max = merit.equality_max;
  times_.total_us = 1e-3 * static_cast<double>(now_ns() - start_ns);
  return report;
}

void Sqp::feedback_gain(int k, Eigen::Matrix<double, kInputs, kStates>& gain) const noexcept {
  const ocp::InputProjection& projection = projections_[k];
  const LqStage& stage = stages_[k];
  const int constraints = stage.form == StageForm::flow ? stage.constraints : 0;
  for (int c = 0; c < kStates; ++c) {
    for (int i = 0; i < kInputs; ++i) {
      double sum = 0.0;
      for (int r = 0; r < constraints; ++r) sum += projection.Y[r][i] * stage.G[kBaseRows + r][c];
      for (int j = 0; j < stage.free_inputs; ++j) sum += projection.W[j][i] * gains_[k].K[j][c];
      gain(i, c) = sum;
    }
    if (projection.first_force < 0) continue;
    for (int axis = 0; axis < 2; ++axis) gain(projection.first_force + axis, c) += projection.F[axis][c];
  }
}

}  // namespace stilt::solver
