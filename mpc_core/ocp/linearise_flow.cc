#include <algorithm>

#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/linearise.h"

// Projection of the constraints, stages in SIMD lanes: docs/decisions/0003-projected-multiple-shooting.md
namespace stilt::ocp {
namespace {

using lq::kBaseRows;
using lq::LqFirstOrder;
using lq::LqSecondOrder;
using model::kAngles;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

/// Stores h, form, G, L, B and b from the rows of the base and the joints' accelerations.
template <class Mode>
void store_dynamics(const StageBatch& batch, const BatchIterate& it, const BaseStep& step,
                    const Eliminations<Mode>& by, const BatchModel& to) noexcept {
  const ForceElimination<Mode>& force = by.force;
  const ConstraintElimination<Mode>& constraint = by.constraint;
  constexpr int kFree = Mode::kFree;
  constexpr int kConstraints = Mode::kConstraints;
  for (int lane = 0; lane < kLanes; ++lane) {
    to.first[lane]->h = batch.duration[lane];
    to.first[lane]->form = lq::StageForm::flow;
    to.first[lane]->constraints = kConstraints;
    to.first[lane]->free_inputs = kFree;
  }
  const Batch h = batch.duration;
  const Batch half_h2 = 0.5 * h * h;
  Batch b[kStates];
  Batch base_by_free[kBaseRows][kFree];
  next_state(it.x, it.u, h, step, b);

  double* rows[kLanes];
  for (int i = 0; i < kBaseRows; ++i) {
    const int axis = i % 3;
    const Batch* slope = i < 3 ? step.d_position[axis] : step.d_velocity[axis];
    const Slopes slopes{slope, slope + kAngles, slope + 2 * kAngles};
    const SubstitutedRow<Mode> substituted(force, slopes);
    const auto by_state = [&](auto c) STILT_INLINE { return substituted.template by_state<c>(); };
    const ReducedRow<Mode, decltype(by_state)> row(constraint, substituted.by_z, by_state);
    b[lq::kBaseRow[i]] += substituted.step + row.step_through_z();
    lq::unroll<kFree>([&](auto k)
                          STILT_INLINE { base_by_free[i][k] = row.template entry<kFirstFree + k>(); });
    to.rows([&](LqFirstOrder& stage) { return stage.G[i]; }, rows);
    store_rows<kStates>(rows, [&](auto c) STILT_INLINE -> Batch {
      if constexpr (c == 0) {
        return Batch(0.0);
      } else {
        return row.template entry<c - 1>();
      }
    });
  }
  // A column of all states, from its entries in the rows of the base and its joint accelerations.
  const auto store_column = [&](const auto& base, const Batch* acceleration) STILT_INLINE {
    store_rows<kStates>(rows, [&](auto state) STILT_INLINE -> Batch {
      constexpr int kVelocity = state >= kPositions ? 1 : 0;
      constexpr int kPosition = state - kVelocity * kPositions;
      if constexpr (kPosition < kFirstJoint) {
        return base(std::integral_constant<int, kPosition + 3 * kVelocity>{});
      } else {
        return (kVelocity ? h : half_h2) * acceleration[kPosition - kFirstJoint];
      }
    });
  };
  to.rows([](LqFirstOrder& stage) { return stage.b; }, rows);
  store_rows<kStates>(rows, [&](auto i) STILT_INLINE -> Batch {
    constexpr int kJoint = i % kPositions - kFirstJoint;
    Batch entry = b[i] - it.x_next[i];
    if constexpr (kJoint >= 0) entry += (i < kPositions ? half_h2 : h) * constraint.z0[kJoint];
    return entry;
  });
  for (int k = 0; k < kFree; ++k) {
    to.rows([&](LqFirstOrder& stage) { return stage.B[k]; }, rows);
    store_column([&](auto i) STILT_INLINE { return base_by_free[i][k]; }, constraint.W[k]);
  }
  for (int r = 0; r < kConstraints; ++r) {
    to.rows([&](LqFirstOrder& stage) { return stage.G[kBaseRows + r]; }, rows);
    store_rows<kStates>(rows, [&](auto c) -> Batch {
      if constexpr (c == 0)
        return Batch(0.0);
      else if constexpr (c == 1)
        return Batch(constraint.by_height[r]);
      else
        return constraint.row[r][c - kFirstAngle];
    });
    to.rows([&](LqFirstOrder& stage) { return stage.L[r]; }, rows);
    store_column([](int) STILT_INLINE { return Batch(0.0); }, constraint.Y[r]);
  }
}

/// Stores Q, S, R, q, r and the slope along u0.
template <class Mode>
void store_cost(const QuadraticCost& cost, const BatchModel& to) noexcept {
  constexpr int kFree = Mode::kFree;
  double* rows[kLanes];
  // Column c of Q below the diagonal. Order of the states: x_b, then the columns of the cost.
  lq::unroll<kStates>([&](auto column) STILT_INLINE {
    constexpr int c = column;
    to.rows([](LqSecondOrder& stage) { return stage.Q[c]; }, rows);
    store_rows<kStates, c / kLanes>(rows, [&](auto state) -> Batch {
      constexpr int d = state;
      constexpr int kAngle = d - kFirstAngle;
      if constexpr (d < c)
        return Batch(0.0);
      else if constexpr (c > 0)
        return cost.H[d - 1][c - 1];
      else if constexpr (d == 0)
        return cost.x_curvature;
      else if constexpr (kAngle >= 0 && kAngle < kAngles)
        return cost.x_by_theta[kAngle];
      else
        return Batch(0.0);
    });
  });
  to.rows([](LqFirstOrder& stage) { return stage.q; }, rows);
  store_rows<kStates>(rows, [&](auto d) { return d == 0 ? cost.x_gradient : cost.g[d == 0 ? 0 : d - 1]; });
  for (int k = 0; k < kFree; ++k) {
    to.rows([&](LqSecondOrder& stage) { return stage.S[k]; }, rows);
    store_rows<kStates>(
        rows, [&](auto d) { return d == 0 ? Batch(0.0) : cost.H[kFirstFree + k][d == 0 ? 0 : d - 1]; });
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    to.inputs[lane]->u0_slope = cost.constraint_step_slope[lane];
    for (int k = 0; k < kFree; ++k) {
      to.first[lane]->r[k] = cost.g[kFirstFree + k][lane];
      for (int i = k; i < kFree; ++i) to.second[lane]->R[k][i] = cost.H[kFirstFree + i][kFirstFree + k][lane];
    }
  }
}

/// Stores the projection du = u0 + Y c + W w + [0; F dx; 0].
template <class Mode>
void store_projection(const Eliminations<Mode>& by, const BatchModel& to) noexcept {
  const ForceElimination<Mode>& force = by.force;
  const ConstraintElimination<Mode>& constraint = by.constraint;
  double* rows[kLanes];
  // Stores a vector of inputs that moves z by `z` and the swing forces by `swing`.
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
  to.rows([](InputProjection& inputs) { return inputs.u0; }, rows);
  store_inputs(constraint.z0, true);
  for (int r = 0; r < Mode::kConstraints; ++r) {
    to.rows([&](InputProjection& inputs) { return inputs.Y[r]; }, rows);
    store_inputs(constraint.Y[r], false);
  }
  for (int k = 0; k < Mode::kFree; ++k) {
    to.rows([&](InputProjection& inputs) { return inputs.W[k]; }, rows);
    store_inputs(constraint.W[k], false);
  }
  if constexpr (Mode::kStanceFeet > 0) {
    for (int axis = 0; axis < 2; ++axis) {
      to.rows([&](InputProjection& inputs) { return inputs.F[axis]; }, rows);
      store_rows<kStates>(rows, [&](auto state) -> Batch {
        if constexpr (state < kFirstAngle)
          return Batch(0.0);
        else
          return force.slope[axis][state - kFirstAngle];
      });
    }
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    to.inputs[lane]->first_force = Mode::kStanceFeet > 0 ? Mode::kFirstForce : -1;
  }
}

template <class Mode>
void linearise_mode(const ProblemData& data, std::span<const StageBatch> batches, const Trajectory& iterate,
                    const BatchModel* to, LineariseWorkspace& work) noexcept {
  using Flow = LineariseWorkspace::Flow;
  const BatchParameters parameters(data);
  const BarrierCurves barriers(data.inequality);
  const auto for_each = [&](const auto& step) STILT_INLINE {
    for (std::size_t i = 0; i < batches.size(); ++i) step(batches[i], work.flow[i], to[i]);
  };
  for_each([&](const StageBatch& batch, Flow& flow, const BatchModel&) {
    flow.it = BatchIterate(iterate, batch);
    data.robot->node_derivatives(flow.it.x, flow.it.u, parameters.value, flow.node);
  });
  for_each([&](const StageBatch& batch, Flow& flow, const BatchModel& model) {
    integrate_base_derivatives(*data.robot, data.discretisation.integrator, flow.it.x, flow.it.u,
                               batch.duration, flow.node, work.step, work.integrator);
    Eliminations<Mode>& by = flow.eliminations.of<Mode>();
    by.eliminate(data.equality, batch, flow.it.u, flow.node);
    store_dynamics(batch, flow.it, work.step, by, model);
    store_projection(by, model);
  });
  for_each([&](const StageBatch& batch, Flow& flow, const BatchModel& model) {
    const Eliminations<Mode>& by = flow.eliminations.of<Mode>();
    add_input_terms(data, barriers, batch, flow.it, flow.node, by.force, by.constraint, work.cost);
    add_state_terms<Mode>(data, barriers, batch, flow.it, flow.node, work.cost);
    store_cost<Mode>(work.cost, model);
  });
}

}  // namespace

void linearise(const ProblemData& data, std::span<const StageBatch> batches, const Trajectory& iterate,
               const BatchModel* to, LineariseWorkspace& work) noexcept {
  dispatch(batches[0].mode,
           [&]<class Mode>(Mode) { linearise_mode<Mode>(data, batches, iterate, to, work); });
}

}  // namespace stilt::ocp
