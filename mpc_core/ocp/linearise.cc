#include <algorithm>

#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/linearise_workspace.h"

namespace stilt::ocp {
namespace {

using model::kAngles;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;
using solver::kBaseRows;
using solver::kRows;
using solver::LqStage;

/// Height of the hip and the columns of a row: all of the state but x_b, as LqStage stores it.
constexpr int kHeightState = 1;

/// The stages of a batch, a lane each; unused lanes repeat the last one and write the same.
struct BatchStages {
  LqStage* stage[kLanes];
  InputProjection* inputs[kLanes];

  /// Where one vector of each lane's stage lies.
  template <class Member>
  void rows(const Member& member, double* (&out)[kLanes]) const noexcept {
    for (int lane = 0; lane < kLanes; ++lane) out[lane] = member(*stage[lane], *inputs[lane]);
  }
};

/// Sum over the variables of one row or column.
template <class Mode>
Batch over_variables(const Batch* a, const Batch* b) noexcept {
  Batch sum = a[0] * b[0];
  for (int v = 1; v < Mode::kVariables; ++v) sum += a[v] * b[v];
  return sum;
}

/// G, L, B, b from the rows of the base and the joints' accelerations.
template <class Mode>
void store_dynamics(const StageBatch& batch, const BatchIterate& it, const BaseStep& step,
                    const ForceElimination<Mode>& force, const ConstraintElimination<Mode>& constraint,
                    const BatchStages& to) noexcept {
  constexpr int kFree = Mode::kFree;
  constexpr int kConstraints = Mode::kConstraints;
  const Batch h = batch.duration;
  const Batch half_h2 = 0.5 * h * h;
  Batch b[kStates];
  Batch B[kFree][kStates];
  Batch L[kConstraints][kStates];
  next_state(it.x, it.u, h, step, b);
  for (int i = 0; i < kStates; ++i) b[i] -= it.x_next[i];

  double* rows[kLanes];
  for (int i = 0; i < kBaseRows; ++i) {
    const int axis = i % 3;
    const Batch* slope = i < 3 ? step.d_position[axis] : step.d_velocity[axis];
    Batch row[Mode::kColumns];
    const Batch constant = force.substitute({slope, slope + kAngles, slope + 2 * kAngles}, row);
    const Batch* by_z = row + kStateColumns;
    const int state = solver::kBaseRow[i];
    b[state] += constant + over_variables<Mode>(by_z, constraint.z0);
    for (int k = 0; k < kFree; ++k) B[k][state] = over_variables<Mode>(by_z, constraint.W[k]);
    Batch height = Batch(0.0);
    for (int r = 0; r < kConstraints; ++r) {
      L[r][state] = Batch(0.0);
      const Batch through = over_variables<Mode>(by_z, constraint.Y[r]);
      height += through * constraint.by_height[r];
      for (int c = 0; c < kStateColumns; ++c) row[c] += through * constraint.row[r][c];
    }
    to.rows([&](LqStage& stage, InputProjection&) { return stage.G[i]; }, rows);
    store_rows<kStates>(rows, [&](auto c) -> Batch {
      if constexpr (c < kHeightState)
        return Batch(0.0);
      else if constexpr (c == kHeightState)
        return height;
      else
        return row[c - kFirstAngle];
    });
  }
  for (int j = 0; j < kJoints; ++j) {
    const int q = kFirstJoint + j;
    const int v = kPositions + q;
    b[q] += half_h2 * constraint.z0[j];
    b[v] += h * constraint.z0[j];
    for (int k = 0; k < kFree; ++k) {
      B[k][q] = half_h2 * constraint.W[k][j];
      B[k][v] = h * constraint.W[k][j];
    }
    for (int r = 0; r < kConstraints; ++r) {
      L[r][q] = half_h2 * constraint.Y[r][j];
      L[r][v] = h * constraint.Y[r][j];
    }
  }
  to.rows([](LqStage& stage, InputProjection&) { return stage.b; }, rows);
  store_rows<kStates>(rows, [&](auto i) { return b[i]; });
  for (int k = 0; k < kFree; ++k) {
    to.rows([&](LqStage& stage, InputProjection&) { return stage.B[k]; }, rows);
    store_rows<kStates>(rows, [&](auto i) { return B[k][i]; });
  }
  for (int r = 0; r < kConstraints; ++r) {
    to.rows([&](LqStage& stage, InputProjection&) { return stage.G[kBaseRows + r]; }, rows);
    store_rows<kStates>(rows, [&](auto c) -> Batch {
      if constexpr (c < kHeightState)
        return Batch(0.0);
      else if constexpr (c == kHeightState)
        return Batch(constraint.by_height[r]);
      else
        return constraint.row[r][c - kFirstAngle];
    });
    to.rows([&](LqStage& stage, InputProjection&) { return stage.L[r]; }, rows);
    store_rows<kStates>(rows, [&](auto i) { return L[r][i]; });
  }
}

/// Q, S, R, q, r: the cost over (dx, z) with z = z0 + Y c + W w, c = row dx + by_height dz_b. With T = H_zz Y
/// and per constraint v = H_xz Y + 1/2 (Y'T) row the state's Hessian gains row v' + v row'.
template <class Mode>
void store_cost(const ConstraintElimination<Mode>& constraint, QuadraticCost& cost,
                const BatchStages& to) noexcept {
  constexpr int kFree = Mode::kFree;
  constexpr int kConstraints = Mode::kConstraints;
  constexpr int kVariables = Mode::kVariables;
  constexpr int kColumns = kStateColumns + 1;  ///< height, then the columns of the cost
  Batch Hzz[kVariables][kVariables];
  for (int i = 0; i < kVariables; ++i) {
    for (int j = 0; j < kVariables; ++j) {
      Hzz[i][j] = cost.H[kStateColumns + std::max(i, j)][kStateColumns + std::min(i, j)];
    }
  }
  const Batch* gz = cost.g + kStateColumns;
  Batch T[kConstraints][kVariables];
  Batch row[kConstraints][kColumns];
  Batch v[kConstraints][kColumns];
  for (int r = 0; r < kConstraints; ++r) {
    for (int i = 0; i < kVariables; ++i) T[r][i] = over_variables<Mode>(Hzz[i], constraint.Y[r]);
    row[r][0] = Batch(constraint.by_height[r]);
    v[r][0] = Batch(0.0);
    for (int c = 0; c < kStateColumns; ++c) {
      row[r][1 + c] = constraint.row[r][c];
      Batch sum = cost.H[kStateColumns][c] * constraint.Y[r][0];
      for (int i = 1; i < kVariables; ++i) sum += cost.H[kStateColumns + i][c] * constraint.Y[r][i];
      v[r][1 + c] = sum;
    }
  }
  Batch slope[kConstraints];
  for (int r = 0; r < kConstraints; ++r) {
    slope[r] = over_variables<Mode>(gz, constraint.Y[r]);
    for (int s = 0; s < kConstraints; ++s) {
      const Batch half = 0.5 * over_variables<Mode>(T[s], constraint.Y[r]);
      for (int c = 0; c < kColumns; ++c) v[r][c] += half * row[s][c];
    }
  }

  // Column c of Q below the diagonal, states in order: x_b, z_b, then the columns of the cost.
  double* rows[kLanes];
  const auto coupled = [&](int c, int d) {
    Batch sum = row[0][c] * v[0][d] + v[0][c] * row[0][d];
    for (int r = 1; r < kConstraints; ++r) sum += row[r][c] * v[r][d] + v[r][c] * row[r][d];
    return sum;
  };
  solver::unroll<kStates>([&](auto column) STILT_INLINE {
    constexpr int c = column;
    to.rows([](LqStage& stage, InputProjection&) { return stage.Q[c]; }, rows);
    store_rows<kStates, c / kLanes>(rows, [&](auto state) -> Batch {
      constexpr int d = state;
      if constexpr (d < c || (c == 0 && d == kHeightState))
        return Batch(0.0);
      else if constexpr (c == 0)
        return d == 0 ? cost.base_curvature[0] : cost.base_by_state[0][d - kFirstAngle];
      else if constexpr (d == kHeightState)
        return cost.base_curvature[1] + coupled(0, 0);
      else if constexpr (c == kHeightState)
        return cost.base_by_state[1][d - kFirstAngle] + coupled(0, d - 1);
      else
        return cost.H[d - kFirstAngle][c - kFirstAngle] + coupled(c - 1, d - 1);
    });
  });
  to.rows([](LqStage& stage, InputProjection&) { return stage.q; }, rows);
  store_rows<kStates>(rows, [&](auto state) -> Batch {
    constexpr int d = state;
    if constexpr (d == 0) {
      return cost.base_gradient[0];
    } else {
      Batch sum = d == kHeightState ? cost.base_gradient[1] : cost.g[d - kFirstAngle];
      for (int r = 0; r < kConstraints; ++r) sum += slope[r] * row[r][d - 1];
      return sum;
    }
  });

  Batch R[kFree][kFree];
  Batch r_free[kFree];
  for (int k = 0; k < kFree; ++k) {
    Batch HW[kVariables];
    for (int i = 0; i < kVariables; ++i) HW[i] = over_variables<Mode>(Hzz[i], constraint.W[k]);
    for (int i = 0; i <= k; ++i) R[i][k] = R[k][i] = over_variables<Mode>(HW, constraint.W[i]);
    r_free[k] = over_variables<Mode>(gz, constraint.W[k]);
    Batch through[kConstraints];
    for (int r = 0; r < kConstraints; ++r) through[r] = over_variables<Mode>(T[r], constraint.W[k]);
    to.rows([&](LqStage& stage, InputProjection&) { return stage.S[k]; }, rows);
    store_rows<kStates>(rows, [&](auto state) -> Batch {
      constexpr int d = state;
      if constexpr (d == 0) {
        return Batch(0.0);
      } else {
        Batch sum = through[0] * row[0][d - 1];
        for (int r = 1; r < kConstraints; ++r) sum += through[r] * row[r][d - 1];
        if constexpr (d >= kFirstAngle) {
          for (int i = 0; i < kVariables; ++i) {
            sum += constraint.W[k][i] * cost.H[kStateColumns + i][d - kFirstAngle];
          }
        }
        return sum;
      }
    });
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    LqStage& stage = *to.stage[lane];
    for (int k = 0; k < kFree; ++k) {
      stage.r[k] = r_free[k][lane];
      for (int i = k; i < kFree; ++i) stage.R[k][i] = R[k][i][lane];
    }
  }
}

/// du = u0 + Y c + W w + [0; F dx; 0].
template <class Mode>
void store_projection(const ForceElimination<Mode>& force, const ConstraintElimination<Mode>& constraint,
                      const Batch& drift, const BatchStages& to) noexcept {
  double* rows[kLanes];
  // Entry i of a vector of inputs that moves z by `z` and swing forces by `swing`.
  const auto store_inputs = [&](const Batch* z, bool constant) {
    Batch entry[kInputs];
    for (int i = 0; i < 2 * model::kFeet; ++i) {
      entry[kJoints + i] = constant && !Mode::stance(i / 2) ? force.swing_step[i] : Batch(0.0);
    }
    for (int v = 0; v < Mode::kVariables; ++v) entry[Mode::input(v)] = z[v];
    if constexpr (Mode::kStanceFeet > 0) {
      for (int axis = 0; axis < 2; ++axis) {
        Batch sum = over_variables<Mode>(force.slope[axis] + kStateColumns, z);
        if (constant) sum += force.constant[axis];
        entry[Mode::kFirstForce + axis] = sum;
      }
    }
    store_rows<kInputs>(rows, [&](auto i) { return entry[i]; });
  };
  to.rows([](LqStage&, InputProjection& inputs) { return inputs.u0; }, rows);
  store_inputs(constraint.z0, true);
  for (int r = 0; r < Mode::kConstraints; ++r) {
    to.rows([&](LqStage&, InputProjection& inputs) { return inputs.Y[r]; }, rows);
    store_inputs(constraint.Y[r], false);
  }
  for (int k = 0; k < Mode::kFree; ++k) {
    to.rows([&](LqStage&, InputProjection& inputs) { return inputs.W[k]; }, rows);
    store_inputs(constraint.W[k], false);
  }
  if constexpr (Mode::kStanceFeet > 0) {
    for (int axis = 0; axis < 2; ++axis) {
      to.rows([&](LqStage&, InputProjection& inputs) { return inputs.F[axis]; }, rows);
      store_rows<kStates>(rows, [&](auto state) -> Batch {
        if constexpr (state < kFirstAngle)
          return Batch(0.0);
        else
          return force.slope[axis][state - kFirstAngle];
      });
    }
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    to.inputs[lane]->u0_slope = drift[lane];
    to.inputs[lane]->first_force = Mode::kStanceFeet > 0 ? Mode::kFirstForce : -1;
  }
}

template <class Mode>
void linearise_batch(const ProblemData& data, const BatchParameters& parameters, const StageBatch& batch,
                     const Trajectory& iterate, LqStage* stages, InputProjection* projections,
                     LineariseWorkspace& work) noexcept {
  BatchStages to;
  for (int lane = 0; lane < kLanes; ++lane) {
    to.stage[lane] = stages + batch.stage[lane];
    to.inputs[lane] = projections + batch.stage[lane];
    to.stage[lane]->h = batch.duration[lane];
    to.stage[lane]->form = solver::StageForm::flow;
    to.stage[lane]->constraints = Mode::kConstraints;
    to.stage[lane]->free_inputs = Mode::kFree;
  }
  const BatchIterate it(iterate, batch);
  data.robot->batch.node_derivatives(it.x, it.u, parameters.value, work.node);
  integrate_base_derivatives(*data.robot, data.discretisation.integrator, it.x, it.u, batch.duration,
                             work.node, work.step, work.integrator);
  const ForceElimination<Mode> force(data.equality, batch, it.u, work.node);
  const ConstraintElimination<Mode> constraint(data.equality, batch, work.node, force);
  store_dynamics(batch, it, work.step, force, constraint, to);
  add_input_terms(data, batch, it, work.node, force, constraint, work.cost);
  add_state_terms<Mode>(data, batch, it, work.node, work.cost);
  store_cost(constraint, work.cost, to);
  store_projection(force, constraint, work.cost.drift, to);
}

/// Velocity after the touch-downs of a batch, one foot after the other when two land, with its derivatives by
/// the state before: rows of A for the velocities.
struct TouchDown {
  Batch after[kStates];
  Batch A[kPositions][kStates];

  TouchDown(const ProblemData& data, const BatchParameters& parameters, const TransitionBatch& batch,
            const Batch* x) noexcept {
    std::copy(x, x + kStates, after);
    for (int r = 0; r < kPositions; ++r) {
      for (int c = 0; c < kStates; ++c) A[r][c] = Batch(c == kPositions + r ? 1.0 : 0.0);
    }
    if (data.discretisation.transition == Transition::identity) return;
    for (int foot = 0; foot < model::kFeet; ++foot) {
      if (batch.touchdown[foot]) follow(data, parameters, foot);
    }
  }

 private:
  void follow(const ProblemData& data, const BatchParameters& parameters, int foot) noexcept {
    model::ImpactDerivatives<Batch> impact;
    data.robot->batch.impact_derivatives[foot](after, parameters.value, impact);
    for (int c = 0; c < kStates; ++c) {
      Batch column[kPositions];
      for (int r = 0; r < kPositions; ++r) {
        const bool angle = c >= kFirstAngle && c < kFirstAngle + kAngles;
        column[r] = angle ? impact.velocity_after_dtheta[r][c - kFirstAngle] : Batch(0.0);
        for (int k = 0; k < kPositions; ++k) column[r] += impact.velocity_after_dv[r][k] * A[k][c];
      }
      for (int r = 0; r < kPositions; ++r) A[r][c] = column[r];
    }
    std::copy(impact.velocity_after, impact.velocity_after + kPositions, after + kPositions);
  }
};

/// x+ = x with the velocity possibly changed by the impact of the feet that touch down; cost on their
/// horizontal velocity before it.
void linearise_transitions(const ProblemData& data, const BatchParameters& parameters,
                           const TransitionBatch& batch, const Trajectory& iterate, LqStage* stages,
                           InputProjection* projections, LineariseWorkspace& work) noexcept {
  BatchStages to;
  for (int lane = 0; lane < kLanes; ++lane) {
    LqStage& stage = *(to.stage[lane] = stages + batch.stage[lane]);
    stage.h = 0.0;
    stage.form = solver::StageForm::transition;
    stage.constraints = stage.free_inputs = 0;
    InputProjection& inputs = *(to.inputs[lane] = projections + batch.stage[lane]);
    std::fill(inputs.u0, inputs.u0 + kInputs, 0.0);
    inputs.u0_slope = 0.0;
    inputs.first_force = -1;
  }
  const BatchTransition it(iterate, batch);
  const TouchDown touchdown(data, parameters, batch, it.x);

  // Cost 1/2 weight (horizontal velocity of the foot)^2.
  Batch row[model::kFeet][kStates] = {};
  Batch speed[model::kFeet] = {};
  Batch no_input[kInputs] = {};
  data.robot->batch.node_derivatives(it.x, no_input, parameters.value, work.node);
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (!batch.touchdown[foot]) continue;
    speed[foot] = work.node.foot_velocity[2 * foot];
    row[foot][kPositions] = Batch(1.0);
    for (int c = 0; c < model::kChain; ++c) {
      const int angle = kFirstAngle + model::kChainAngles[foot][c];
      row[foot][angle] = work.node.foot_velocity_dchain[2 * foot][c];
      row[foot][kPositions + angle] = work.node.foot_position_dchain[2 * foot][c];
    }
  }
  const double weight = data.cost.touchdown_velocity;

  double* rows[kLanes];
  for (int i = 0; i < kPositions; ++i) {
    to.rows([&](LqStage& stage, InputProjection&) { return stage.G[i]; }, rows);
    store_rows<kStates>(rows, [&](auto c) { return touchdown.A[i][c] - (c == kPositions + i ? 1.0 : 0.0); });
  }
  for (int c = 0; c < kStates; ++c) {
    to.rows([&](LqStage& stage, InputProjection&) { return stage.Q[c]; }, rows);
    store_rows<kStates>(rows,
                        [&](auto r) { return weight * (row[0][c] * row[0][r] + row[1][c] * row[1][r]); });
  }
  to.rows([](LqStage& stage, InputProjection&) { return stage.q; }, rows);
  store_rows<kStates>(rows, [&](auto c) { return weight * (row[0][c] * speed[0] + row[1][c] * speed[1]); });
  to.rows([](LqStage& stage, InputProjection&) { return stage.b; }, rows);
  store_rows<kStates>(rows, [&](auto i) { return touchdown.after[i] - it.x_next[i]; });
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
               InputProjection* projections, solver::LqTerminal& terminal,
               LineariseWorkspace& work) noexcept {
  const BatchParameters parameters(data);
  for (int b = 0; b < problem.batches; ++b) {
    const StageBatch& batch = problem.batch[b];
    dispatch(batch.mode, [&]<class Mode>(Mode) {
      linearise_batch<Mode>(data, parameters, batch, iterate, stages, projections, work);
    });
  }
  for (int b = 0; b < problem.transition_batches; ++b) {
    linearise_transitions(data, parameters, problem.transition_batch[b], iterate, stages, projections, work);
  }
  linearise_terminal(data, problem, iterate.x[problem.horizon.stages], terminal);
}

}  // namespace stilt::ocp
