#include "mpc_core/ocp/cost_rows.h"

namespace stilt::ocp {
namespace {

using model::kChain;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;
using model::kStates;

/// Adds 1/2 weight (error + sum_i row[i] dx[index[i]])^2.
template <int N>
void add_sparse_row(const Batch& weight, const Batch& error, const Batch (&row)[N], const int (&index)[N],
                    Batch (&gradient)[kStates], Batch (&hessian)[kStates][kStates]) noexcept {
  for (int i = 0; i < N; ++i) {
    const Batch weighted = weight * row[i];
    gradient[index[i]] += weighted * error;
    for (int j = 0; j < N; ++j) hessian[index[i]][index[j]] += weighted * row[j];
  }
}

/// Adds the barriers of lower <= value <= upper on one state.
void add_limits(const BarrierParameters& parameters, const Batch& value, double lower, double upper,
                Batch& gradient, Batch& curvature) noexcept {
  const BarrierSlope above = barrier_slope(parameters, value - lower);
  const BarrierSlope below = barrier_slope(parameters, upper - value);
  gradient += above.first - below.first;
  curvature += above.second + below.second;
}

}  // namespace

void add_state_terms(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                     const model::NodeDerivatives<Batch>& node, Batch (&gradient)[kStates],
                     Batch (&hessian)[kStates][kStates]) noexcept {
  for (int i = 0; i < kStates; ++i) {
    gradient[i] += data.state_weight[i] * (it.x[i] - batch.x_ref[i]);
    hessian[i][i] += data.state_weight[i];
  }
  for (int j = 0; j < kJoints; ++j) {
    const int q = kFirstJoint + j;
    const int v = kPositions + q;
    add_limits(data.inequality.joint_position, it.x[q], data.limits.position_min_rad[j],
               data.limits.position_max_rad[j], gradient[q], hessian[q][q]);
    add_limits(data.inequality.joint_velocity, it.x[v], -data.limits.velocity_rad_s[j],
               data.limits.velocity_rad_s[j], gradient[v], hessian[v][v]);
  }
  for (int foot = 0; foot < model::kFeet; ++foot) {
    const int a0 = kFirstAngle + model::kChainAngles[foot][0];
    const int a1 = kFirstAngle + model::kChainAngles[foot][1];
    const int a2 = kFirstAngle + model::kChainAngles[foot][2];
    for (int axis = 0; axis < 2; ++axis) {
      const int i = 2 * foot + axis;
      const auto& by_angle = node.foot_position_dchain[i];
      const auto& rate_by_angle = node.foot_velocity_dchain[i];
      const Batch one = Batch(1.0);
      add_sparse_row(Batch(data.cost.foot_position), node.foot_position[i] - batch.foot_position_ref[i],
                     {one, by_angle[0], by_angle[1], by_angle[2]}, {axis, a0, a1, a2}, gradient, hessian);
      add_sparse_row(
          Batch(data.cost.foot_velocity), node.foot_velocity[i] - batch.foot_velocity_ref[i],
          {one, by_angle[0], by_angle[1], by_angle[2], rate_by_angle[0], rate_by_angle[1], rate_by_angle[2]},
          {kPositions + axis, kPositions + a0, kPositions + a1, kPositions + a2, a0, a1, a2}, gradient,
          hessian);
    }
  }
}

}  // namespace stilt::ocp
