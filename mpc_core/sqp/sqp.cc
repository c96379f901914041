#include "mpc_core/sqp/sqp.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mpc_core/lq/simd_columns.h"
#include "mpc_core/model/debug_assert.h"

namespace stilt::sqp {
namespace {

using lq::broadcast;
using lq::kBaseRows;
using lq::kLanes;
using lq::kParts;
using lq::kRows;
using lq::load;
using lq::store;
using lq::SweepOutcome;
using lq::unroll;
using lq::Vec;
using model::kInputs;
using model::kStates;

constexpr int kInputParts = kInputs / kLanes;  ///< registers per input

bool is_finite(const ocp::Merit& merit) noexcept {
  return std::isfinite(merit.cost) && std::isfinite(merit.violation_squared);
}

/// Whether the filter of class Sqp accepts the trial step.
bool acceptable(const SqpParameters& p, const ocp::Merit& now, const ocp::Merit& trial, double length,
                double slope) noexcept {
  if (!is_finite(trial)) return false;
  const double g = std::sqrt(now.violation_squared);
  const double g_new = std::sqrt(trial.violation_squared);
  if (g_new > p.filter_violation_max) return g_new < (1.0 - p.filter_margin) * g;
  if (g < p.filter_violation_min && g_new < p.filter_violation_min && slope < 0.0)
    return trial.cost <= now.cost + p.armijo * length * slope;
  return trial.cost < now.cost - p.filter_margin * g || g_new < (1.0 - p.filter_margin) * g;
}

}  // namespace

SweepOutcome Sqp::sweep_backward(const ocp::ProblemData& data, const ocp::Problem& problem,
                                 const ocp::Trajectory& iterate) noexcept {
  const long long start_ns = now_ns();
  models_.begin(data, problem, iterate);
  lq::BackwardSweep sweep(models_.terminal(), workspace_);
  SweepOutcome outcome = SweepOutcome::ok;
  for (int k = problem.horizon.stages - 1; k >= 0 && outcome == SweepOutcome::ok; --k) {
    const ocp::StageModel stage = models_.at(k);
    outcome = sweep.step(stage.first, stage.second, gains_[k]);
  }
  if (outcome == SweepOutcome::ok && !sweep.finite()) outcome = SweepOutcome::not_finite;
  const long long linearising_ns = models_.linearising_ns();
  times_.linearise_us += 1e-3 * static_cast<double>(linearising_ns);
  times_.riccati_us += 1e-3 * static_cast<double>(now_ns() - start_ns - linearising_ns);
  return outcome;
}

bool Sqp::step(const ocp::ProblemData& data, const ocp::Problem& problem, const ocp::Trajectory& iterate,
               SolveReport& report) noexcept {
  const int stages = problem.horizon.stages;
  const SweepOutcome outcome = sweep_backward(data, problem, iterate);
  if (outcome != SweepOutcome::ok) {
    report.status =
        outcome == SweepOutcome::not_positive_definite ? SolveStatus::not_convex : SolveStatus::not_finite;
    return false;
  }
  const long long start_ns = now_ns();
  alignas(64) double x0[kRows] = {};
  for (int i = 0; i < kStates; ++i) x0[i] = problem.x_initial[i] - iterate.x[0][i];
  slope_ =
      lq::forward_sweep(models_.stages(), models_.inputs(), stages, models_.terminal(), gains_, x0, steps_);
  times_.riccati_us += 1e-3 * static_cast<double>(now_ns() - start_ns);
  // The sweep checks everything but the measured state, which enters here. A non-finite number in any step
  // makes the slope non-finite.
  if (!std::isfinite(slope_)) {
    report.status = SolveStatus::not_finite;
    return false;
  }
  return true;
}

double Sqp::take_step(const ocp::Trajectory& from, double length, int stages,
                      ocp::Trajectory& to) const noexcept {
  Vec largest{};
  const auto take = [&](const double* start, const double* step, double* end) STILT_INLINE {
    const Vec v = load(step);
    const Vec magnitude = v < 0.0 ? -v : v;
    largest = magnitude > largest ? magnitude : largest;
    store(end, load(start) + v * broadcast(length));
  };
  for (int k = 0; k <= stages; ++k) {
    unroll<kParts>([&](auto part) STILT_INLINE {
      constexpr int i = part * kLanes;
      take(from.x[k] + i, steps_[k].x + i, to.x[k] + i);
    });
  }
  for (int k = 0; k < stages; ++k) {
    unroll<kInputParts>([&](auto part) STILT_INLINE {
      constexpr int i = part * kLanes;
      take(from.u[k] + i, steps_[k].u + i, to.u[k] + i);
    });
  }
  double size = 0.0;
  for (int lane = 0; lane < kLanes; ++lane) size = std::max(size, largest[lane]);
  return length * size;
}

Sqp::Search Sqp::line_search(const ocp::ProblemData& data, const ocp::Problem& problem,
                             const SqpParameters& p, const ocp::Trajectory& iterate, ocp::Trajectory& trial,
                             ocp::Merit& merit, SolveReport& report) noexcept {
  const int stages = problem.horizon.stages;
  const long long start_ns = now_ns();
  Search result = Search::rejected;
  for (double length = 1.0; length >= p.step_min; length *= p.step_decrease) {
    if (report.trial_steps == report.iterations + p.backtracking_steps) {
      result = Search::exhausted;
      break;
    }
    ++report.trial_steps;
    const double component_max = take_step(iterate, length, stages, trial);
    if (length == 1.0) full_step_component_max_ = component_max;
    const ocp::Merit trial_merit = ocp::evaluate(data, problem, trial);
    if (!acceptable(p, merit, trial_merit, length, slope_)) continue;
    merit = trial_merit;
    report.line_search_step = length;
    report.step_component_max = component_max;
    result = Search::accepted;
    break;
  }
  times_.line_search_us += 1e-3 * static_cast<double>(now_ns() - start_ns);
  return result;
}

SolveReport Sqp::solve(const ocp::ProblemData& data, const ocp::Problem& problem, const SqpParameters& p,
                       ocp::Trajectory& iterate) noexcept {
  STILT_ASSERT(p.step_min > 0.0 && p.step_decrease > 0.0 && p.step_decrease < 1.0);
  SolveReport report;
  times_ = PhaseTimes{};
  const long long start_ns = now_ns();
  // The iterate and the trial are exchanged when a step is accepted.
  ocp::Trajectory* current = &iterate;
  ocp::Trajectory* trial = &trial_;
  ocp::Merit merit = ocp::evaluate(data, problem, iterate);
  report.status = is_finite(merit) ? SolveStatus::iteration_limit : SolveStatus::not_finite;
  while (report.status == SolveStatus::iteration_limit && report.iterations < p.iterations) {
    if (!step(data, problem, *current, report)) break;
    ++report.iterations;
    const double cost_before = merit.cost;
    const Search search = line_search(data, problem, p, *current, *trial, merit, report);
    if (search != Search::accepted) report.line_search_step = 0.0;
    if (search == Search::exhausted) break;
    if (search == Search::rejected) {
      // A step this small changes the cost by less than rounding: acceptance means nothing.
      const bool vanished = full_step_component_max_ < p.step_tolerance;
      if (p.early_stop) report.status = vanished ? SolveStatus::converged : SolveStatus::step_rejected;
      continue;
    }
    std::swap(current, trial);
    // A shortened step changes little far from a minimum, too.
    const bool settled = report.line_search_step == 1.0 &&
                         std::abs(merit.cost - cost_before) < p.cost_tolerance &&
                         std::sqrt(merit.violation_squared) < p.violation_tolerance;
    if (p.early_stop && (settled || full_step_component_max_ < p.step_tolerance))
      report.status = SolveStatus::converged;
  }
  if (current != &iterate) {
    const int stages = problem.horizon.stages;
    std::copy(current->x[0], current->x[stages] + kRows, iterate.x[0]);
    std::copy(current->u[0], current->u[stages], iterate.u[0]);
  }
  report.cost = merit.cost;
  report.dynamics_defect_max = merit.dynamics_defect_max;
  report.equality_violation_max = merit.equality_violation_max;
  if (report.usable()) report.violations = ocp::violations(data, problem, iterate);
  times_.total_us = 1e-3 * static_cast<double>(now_ns() - start_ns);
  return report;
}

void Sqp::feedback_gain(int k, Eigen::Matrix<double, kInputs, kStates>& gain) const noexcept {
  const ocp::InputProjection& projection = models_.inputs()[k];
  const lq::LqFirstOrder& stage = models_.stages()[k];
  for (int c = 0; c < kStates; ++c) {
    double* column = gain.data() + c * kInputs;
    unroll<kInputParts>([&](auto part) STILT_INLINE {
      Vec sum{};
      for (int r = 0; r < stage.constraints; ++r) {
        sum += load(projection.Y[r] + part * kLanes) * broadcast(stage.G[kBaseRows + r][c]);
      }
      for (int j = 0; j < stage.free_inputs; ++j) {
        sum += load(projection.W[j] + part * kLanes) * broadcast(gains_[k].K[j][c]);
      }
      store(column + part * kLanes, sum);
    });
    if (projection.first_force < 0) continue;
    column[projection.first_force] += projection.F[0][c];
    column[projection.first_force + 1] += projection.F[1][c];
  }
}

}  // namespace stilt::sqp
