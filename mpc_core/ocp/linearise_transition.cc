#include <algorithm>

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
/// velocities. When two feet land, their impacts are applied one after the other.
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
    data.robot->impact_derivatives(foot, after, parameters.value, impact);
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

}  // namespace

/// Linearises x+ = x, with the velocity changed by the impact of the feet that touch down when impacts are
/// modelled. Adds the cost on the horizontal velocity of these feet before the impact.
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

  // Cost 1/2 weight (horizontal velocity of the foot)^2.
  Batch row[model::kFeet][kStates] = {};
  Batch speed[model::kFeet] = {};
  Batch no_input[kInputs] = {};
  data.robot->node_derivatives(it.x, no_input, parameters.value, node);
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (!batch.touchdown[foot]) continue;
    speed[foot] = node.foot_velocity[2 * foot];
    row[foot][kPositions] = Batch(1.0);
    for (int c = 0; c < model::kChain; ++c) {
      const int angle = kFirstAngle + model::kChainAngles[foot][c];
      row[foot][angle] = node.foot_velocity_dchain[2 * foot][c];
      row[foot][kPositions + angle] = node.foot_position_dchain[2 * foot][c];
    }
  }
  const double weight = data.cost.touchdown_velocity;

  double* rows[kLanes];
  for (int i = 0; i < kPositions; ++i) {
    to.rows([&](LqFirstOrder& stage) { return stage.G[i]; }, rows);
    store_rows<kStates>(rows, [&](auto c) { return touchdown.A[i][c] - (c == kPositions + i ? 1.0 : 0.0); });
  }
  for (int c = 0; c < kStates; ++c) {
    to.rows([&](LqSecondOrder& stage) { return stage.Q[c]; }, rows);
    store_rows<kStates>(rows,
                        [&](auto r) { return weight * (row[0][c] * row[0][r] + row[1][c] * row[1][r]); });
  }
  to.rows([](LqFirstOrder& stage) { return stage.q; }, rows);
  store_rows<kStates>(rows, [&](auto c) { return weight * (row[0][c] * speed[0] + row[1][c] * speed[1]); });
  to.rows([](LqFirstOrder& stage) { return stage.b; }, rows);
  store_rows<kStates>(rows, [&](auto i) { return touchdown.after[i] - it.x_next[i]; });
}

}  // namespace stilt::ocp
