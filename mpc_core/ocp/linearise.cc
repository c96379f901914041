#include <algorithm>

#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/cost_rows.h"
#include "mpc_core/ocp/integrator.h"
#include "mpc_core/ocp/problem.h"
#include "mpc_core/ocp/projection.h"

namespace stilt::ocp {
namespace {

using model::kAngles;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;
using solver::kMaxFreeInputs;
using solver::kRows;
using solver::LqStage;

/// The projected quadratic model of a batch of stages; [column][row] like LqStage.
template <class Mode>
struct BatchModel {
  Batch A[kStates][kStates];
  Batch B[Mode::kFree][kStates];
  Batch b[kStates];
  Batch Q[kStates][kStates];
  Batch q[kStates];
  Batch S[Mode::kFree][kStates];
  Batch R[Mode::kFree][Mode::kFree];
  Batch r[Mode::kFree];
  Batch u0_slope;
};

/// Row r of the averaged base acceleration in (dx, w): by reduced states, by free inputs, constant part.
template <class Mode>
struct ProjectedRow {
  Batch dx[kReducedStates];
  Batch w[Mode::kFree];
  Batch constant;

  ProjectedRow(const Batch (&slope)[BaseStep::kColumns], const Projection<Mode>& projection) noexcept {
    for (Batch& entry : dx) entry = Batch(0.0);
    for (int c = 0; c < kAngles; ++c) {
      dx[kThetaColumn + c] = slope[c];
      dx[kOmegaColumn + c] = slope[kAngles + c];
    }
    for (Batch& entry : w) entry = Batch(0.0);
    constant = Batch(0.0);
    for (int i = 0; i < kInputs; ++i) {
      const Batch& by_input = slope[2 * kAngles + i];
      constant += by_input * projection.u0[i];
      if (i >= kJoints && !Mode::stance((i - kJoints) / 2)) continue;
      for (int c = 0; c < kReducedStates; ++c) dx[c] += by_input * projection.X[i][c];
      for (int c = 0; c < Mode::kFree; ++c) w[c] += by_input * projection.W[i][c];
    }
  }
};

/// A, B, b: position row q gets h^2 times the averaged acceleration, velocity row h times.
template <class Mode>
void fill_dynamics(const StageBatch& batch, const BatchIterate& it, const BaseStep& step,
                   const Projection<Mode>& projection, BatchModel<Mode>& out) noexcept {
  const Batch h = batch.duration;
  Batch reached[kStates];
  next_state(it.x, it.u, h, step, reached);
  const auto set_row = [&](int row, const Batch& scale, const Batch* dx, const Batch* w,
                           const Batch& constant) {
    out.A[0][row] = Batch(row == 0 ? 1.0 : 0.0);
    for (int c = 0; c < kReducedStates; ++c) {
      out.A[c + 1][row] = scale * dx[c] + (c + 1 == row ? 1.0 : 0.0);
    }
    if (row < kPositions) out.A[kPositions + row][row] += h;
    for (int c = 0; c < Mode::kFree; ++c) out.B[c][row] = scale * w[c];
    out.b[row] = reached[row] - it.x_next[row] + scale * constant;
  };
  for (int r = 0; r < 3; ++r) {
    const ProjectedRow<Mode> position(step.d_position[r], projection);
    const ProjectedRow<Mode> velocity(step.d_velocity[r], projection);
    set_row(r, h * h, position.dx, position.w, position.constant);
    set_row(kPositions + r, h, velocity.dx, velocity.w, velocity.constant);
  }
  for (int j = 0; j < kJoints; ++j) {
    const int row = kFirstJoint + j;
    set_row(row, 0.5 * h * h, projection.X[j], projection.W[j], projection.u0[j]);
    set_row(kPositions + row, h, projection.X[j], projection.W[j], projection.u0[j]);
  }
}

/// Q, S, R, q, r, all times the duration of the stage.
template <class Mode>
void fill_cost(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
               const model::NodeDerivatives<Batch>& node, const Projection<Mode>& projection,
               BatchModel<Mode>& out) noexcept {
  constexpr int kColumns = DenseRows<Mode>::kColumns;
  DenseRows<Mode> rows(projection);
  add_dense_rows(data, batch, it, node, rows);
  Batch gradient[kColumns];
  Batch hessian[kColumns][kColumns];
  rows.accumulate(gradient, hessian);

  for (int c = 0; c < kStates; ++c) {
    out.q[c] = c > 0 ? gradient[c - 1] : Batch(0.0);
    for (int r = 0; r < kStates; ++r) {
      out.Q[c][r] = c > 0 && r > 0 ? hessian[std::max(c, r) - 1][std::min(c, r) - 1] : Batch(0.0);
    }
  }
  add_state_terms(data, batch, it, node, out.q, out.Q);
  const Batch h = batch.duration;
  out.u0_slope = h * rows.drift();
  for (int c = 0; c < kStates; ++c) {
    out.q[c] *= h;
    for (int r = 0; r < kStates; ++r) out.Q[c][r] *= h;
  }
  for (int i = 0; i < Mode::kFree; ++i) {
    const Batch(&row)[kColumns] = hessian[kReducedStates + i];
    out.r[i] = h * gradient[kReducedStates + i];
    out.S[i][0] = Batch(0.0);
    for (int c = 0; c < kReducedStates; ++c) out.S[i][c + 1] = h * row[c];
    for (int j = 0; j < Mode::kFree; ++j) {
      out.R[i][j] = h * hessian[kReducedStates + std::max(i, j)][kReducedStates + std::min(i, j)];
    }
  }
}

/// Writes rows of a [columns][kStates] batch array to one lane's padded columns.
template <int Columns>
void store_columns(const Batch (&from)[Columns][kStates], int lane, double (*to)[kRows]) noexcept {
  for (int c = 0; c < Columns; ++c) {
    for (int r = 0; r < kStates; ++r) to[c][r] = from[c][r][lane];
    for (int r = kStates; r < kRows; ++r) to[c][r] = 0.0;
  }
}

void store_vector(const Batch (&from)[kStates], int lane, double (&to)[kRows]) noexcept {
  for (int r = 0; r < kStates; ++r) to[r] = from[r][lane];
  for (int r = kStates; r < kRows; ++r) to[r] = 0.0;
}

template <class Mode>
void store(const BatchModel<Mode>& model, const Projection<Mode>& projection, int lane, LqStage& stage,
           InputProjection& inputs) noexcept {
  stage.free_inputs = Mode::kFree;
  store_columns(model.A, lane, stage.A);
  store_columns(model.Q, lane, stage.Q);
  store_columns(model.B, lane, stage.B);
  store_columns(model.S, lane, stage.S);
  store_vector(model.b, lane, stage.b);
  store_vector(model.q, lane, stage.q);
  for (int i = 0; i < Mode::kFree; ++i) {
    for (int j = 0; j < Mode::kFree; ++j) stage.R[i][j] = model.R[i][j][lane];
    stage.r[i] = model.r[i][lane];
  }
  inputs.u0_slope = model.u0_slope[lane];
  for (int i = 0; i < kInputs; ++i) {
    const bool swing_force = i >= kJoints && !Mode::stance((i - kJoints) / 2);
    inputs.u0[i] = projection.u0[i][lane];
    inputs.X[0][i] = 0.0;
    for (int c = 0; c < kReducedStates; ++c) {
      inputs.X[c + 1][i] = swing_force ? 0.0 : static_cast<double>(projection.X[i][c][lane]);
    }
    for (int c = 0; c < Mode::kFree; ++c) {
      inputs.W[c][i] = swing_force ? 0.0 : static_cast<double>(projection.W[i][c][lane]);
    }
  }
}

template <class Mode>
void linearise_batch(const ProblemData& data, const BatchParameters& parameters, const StageBatch& batch,
                     const Trajectory& iterate, LqStage* stages, InputProjection* projections) noexcept {
  const BatchIterate it(iterate, batch);
  model::NodeDerivatives<Batch> node;
  data.robot->batch.node_derivatives(it.x, it.u, parameters.value, node);
  Projection<Mode> projection;
  project(data.equality, batch, it.u, node, projection);
  BaseStep step;
  integrate_base_derivatives(*data.robot, data.discretisation.integrator, it.x, it.u, batch.duration, node,
                             step);
  BatchModel<Mode> model;
  fill_dynamics(batch, it, step, projection, model);
  fill_cost(data, batch, it, node, projection, model);
  for (int lane = 0; lane < batch.lanes; ++lane) {
    const int k = batch.stage[lane];
    store(model, projection, lane, stages[k], projections[k]);
  }
}

/// x+ = x with the velocity possibly changed by the impact of the feet that touch down (one after the other
/// when two do); cost on their horizontal velocity before it.
void linearise_transition(const ProblemData& data, const Stage& stage, const double* x, const double* x_next,
                          LqStage& out, InputProjection& inputs) noexcept {
  out = LqStage{};
  inputs = InputProjection{};
  double after[kStates];
  for (int i = 0; i < kStates; ++i) {
    after[i] = x[i];
    out.A[i][i] = 1.0;
    out.Q[i][i] = 0.0;
  }
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (!stage.touchdown[foot]) continue;
    model::NodeDerivatives<double> node;
    const double no_input[kInputs] = {};
    data.robot->scalar.node_derivatives(x, no_input, data.joint_parameters, node);
    double row[kStates] = {};
    row[kPositions] = 1.0;
    for (int c = 0; c < model::kChain; ++c) {
      const int angle = kFirstAngle + model::kChainAngles[foot][c];
      row[angle] = node.foot_velocity_dchain[2 * foot][c];
      row[kPositions + angle] = node.foot_position_dchain[2 * foot][c];
    }
    for (int c = 0; c < kStates; ++c) {
      const double weighted = data.cost.touchdown_velocity * row[c];
      out.q[c] += weighted * node.foot_velocity[2 * foot];
      for (int r = 0; r < kStates; ++r) out.Q[c][r] += weighted * row[r];
    }

    if (data.discretisation.transition == Transition::identity) continue;
    model::ImpactDerivatives<double> impact;
    data.robot->scalar.impact_derivatives[foot](after, data.joint_parameters, impact);
    for (int c = 0; c < kStates; ++c) {
      double velocity[kPositions];
      for (int r = 0; r < kPositions; ++r) {
        double sum = 0.0;
        for (int k = 0; k < kAngles; ++k)
          sum += impact.velocity_after_dtheta[r][k] * out.A[c][kFirstAngle + k];
        for (int k = 0; k < kPositions; ++k) sum += impact.velocity_after_dv[r][k] * out.A[c][kPositions + k];
        velocity[r] = sum;
      }
      std::copy(velocity, velocity + kPositions, &out.A[c][kPositions]);
    }
    std::copy(impact.velocity_after, impact.velocity_after + kPositions, after + kPositions);
  }
  for (int i = 0; i < kStates; ++i) out.b[i] = after[i] - x_next[i];
}

void linearise_terminal(const ProblemData& data, const Problem& problem, const double* x,
                        solver::LqTerminal& terminal) noexcept {
  for (int c = 0; c < kStates; ++c) {
    double product = 0.0;
    for (int r = 0; r < kRows; ++r) {
      terminal.Q[c][r] = data.terminal_weight[c][r];
      if (r < kStates) product += data.terminal_weight[c][r] * (x[r] - problem.x_ref_terminal[r]);
    }
    terminal.q[c] = product;
  }
  for (int r = kStates; r < kRows; ++r) terminal.q[r] = 0.0;
}

}  // namespace

void linearise(const ProblemData& data, const Problem& problem, const Trajectory& iterate, LqStage* stages,
               InputProjection* projections, solver::LqTerminal& terminal) noexcept {
  const BatchParameters parameters(data);
  for (int b = 0; b < problem.batches; ++b) {
    const StageBatch& batch = problem.batch[b];
    dispatch(batch.mode, [&]<class Mode>(Mode) {
      linearise_batch<Mode>(data, parameters, batch, iterate, stages, projections);
    });
  }
  for (int k = 0; k < problem.horizon.stages; ++k) {
    const Stage& stage = problem.horizon.stage[k];
    if (stage.kind == StageKind::transition) {
      linearise_transition(data, stage, iterate.x[k], iterate.x[k + 1], stages[k], projections[k]);
    }
  }
  linearise_terminal(data, problem, iterate.x[problem.horizon.stages], terminal);
}

}  // namespace stilt::ocp
