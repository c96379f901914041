#include <algorithm>
#include <utility>

#include "mpc_core/ocp/barrier.h"
#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/linearise.h"

namespace stilt::ocp {
namespace {

using lq::LqFirstOrder;
using lq::LqSecondOrder;
using model::kAngles;
using model::kFirstAngle;
using model::kInputs;
using model::kPositions;
using model::kStates;

/// Velocity after the touch-downs of a batch, with its derivatives by the state before: rows of A for the
/// velocities. Impulses J of the landing feet likewise, rows [x, z] of dJ. When two feet land, their impacts
/// are applied one after the other.
struct TouchDown {
  Batch after[kStates];
  Batch A[kPositions][kStates];
  Batch impulse[model::kFeet][2];
  Batch dJ[model::kFeet][2][kStates];

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
    data.robot->impact_derivatives(foot, after, parameters.value, impact);
    std::copy(impact.impulse, impact.impulse + 2, this->impulse[foot]);
    for (int c = 0; c < kStates; ++c) {
      const bool angle = c >= kFirstAngle && c < kFirstAngle + kAngles;
      for (int axis = 0; axis < 2; ++axis) {
        Batch sum = angle ? impact.impulse_dtheta[axis][c - kFirstAngle] : Batch(0.0);
        for (int k = 0; k < kPositions; ++k) sum += impact.impulse_dv[axis][k] * A[k][c];
        dJ[foot][axis][c] = sum;
      }
      Batch column[kPositions];
      for (int r = 0; r < kPositions; ++r) {
        column[r] = angle ? impact.velocity_after_dtheta[r][c - kFirstAngle] : Batch(0.0);
        for (int k = 0; k < kPositions; ++k) column[r] += impact.velocity_after_dv[r][k] * A[k][c];
      }
      for (int r = 0; r < kPositions; ++r) A[r][c] = column[r];
    }
    std::copy(impact.velocity_after, impact.velocity_after + kPositions, after + kPositions);
  }
};

}  // namespace

/// Linearises x+ = x, with the velocity changed by the impact of the feet that touch down when impacts are
/// modelled. Adds the cost on the horizontal velocity of these feet before the impact. Adds the barriers of
/// the friction cone on their impulses, |Jx| <= mu Jz.
void linearise(const ProblemData& data, const TransitionBatch& batch, const Trajectory& iterate,
               const BatchModel& to, LineariseWorkspace& work) noexcept {
  for (int lane = 0; lane < kLanes; ++lane) {
    LqFirstOrder& stage = *to.first[lane];
    stage.h = 0.0;
    stage.form = lq::StageForm::transition;
    stage.constraints = stage.free_inputs = 0;
    InputProjection& inputs = *to.inputs[lane];
    std::fill(inputs.u0, inputs.u0 + kInputs, 0.0);
    inputs.u0_slope = 0.0;
    inputs.first_force = -1;
  }
  model::NodeDerivatives<Batch>& node = work.flow[0].node;
  const BatchParameters parameters(data);
  const BatchTransition it(iterate, batch);
  const TouchDown touchdown(data, parameters, batch, it.x);

  // Rows of the cost: 1/2 curvature (row dx)^2 + slope row dx.
  constexpr int kRowsPerFoot = 3;
  Batch row[model::kFeet * kRowsPerFoot][kStates];
  Batch slope[model::kFeet * kRowsPerFoot];
  Batch curvature[model::kFeet * kRowsPerFoot];
  int count = 0;
  Batch no_input[kInputs] = {};
  data.robot->node_derivatives(it.x, no_input, parameters.value, node);
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (!batch.touchdown[foot]) continue;
    // Cost 1/2 weight (horizontal velocity of the foot)^2.
    std::fill(row[count], row[count] + kStates, Batch(0.0));
    row[count][kPositions] = Batch(1.0);
    for (int c = 0; c < model::kChain; ++c) {
      const int angle = kFirstAngle + model::kChainAngles[foot][c];
      row[count][angle] = node.foot_velocity_dchain[2 * foot][c];
      row[count][kPositions + angle] = node.foot_position_dchain[2 * foot][c];
    }
    curvature[count] = Batch(data.cost.touchdown_velocity);
    slope[count] = data.cost.touchdown_velocity * node.foot_velocity[2 * foot];
    ++count;
    if (data.discretisation.transition == Transition::identity) continue;
    // Barriers of mu Jz + Jx and mu Jz - Jx.
    const double mu = data.inequality.friction_coefficient;
    const Batch friction_Ns = mu * touchdown.impulse[foot][1];
    const BarrierPair pair(data.inequality.impulse, friction_Ns + touchdown.impulse[foot][0],
                           friction_Ns - touchdown.impulse[foot][0]);
    const auto& dJ = touchdown.dJ[foot];
    for (const auto& [barrier, sign] : {std::pair{pair.a, 1.0}, std::pair{pair.b, -1.0}}) {
      for (int c = 0; c < kStates; ++c) row[count][c] = mu * dJ[1][c] + sign * dJ[0][c];
      slope[count] = barrier.first;
      curvature[count] = barrier.second;
      ++count;
    }
  }
  const auto sum_of_rows = [&](const Batch* factor, int column, int other) {
    Batch sum = Batch(0.0);
    for (int i = 0; i < count; ++i) {
      sum += other < 0 ? factor[i] * row[i][column] : factor[i] * row[i][column] * row[i][other];
    }
    return sum;
  };

  double* rows[kLanes];
  for (int i = 0; i < kPositions; ++i) {
    to.rows([&](LqFirstOrder& stage) { return stage.G[i]; }, rows);
    store_rows<kStates>(rows, [&](auto c) { return touchdown.A[i][c] - (c == kPositions + i ? 1.0 : 0.0); });
  }
  for (int c = 0; c < kStates; ++c) {
    to.rows([&](LqSecondOrder& stage) { return stage.Q[c]; }, rows);
    store_rows<kStates>(rows, [&](auto r) { return sum_of_rows(curvature, c, r); });
  }
  to.rows([](LqFirstOrder& stage) { return stage.q; }, rows);
  store_rows<kStates>(rows, [&](auto c) { return sum_of_rows(slope, c, -1); });
  to.rows([](LqFirstOrder& stage) { return stage.b; }, rows);
  store_rows<kStates>(rows, [&](auto i) { return touchdown.after[i] - it.x_next[i]; });
}

}  // namespace stilt::ocp
