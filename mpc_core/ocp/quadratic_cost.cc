#include "mpc_core/ocp/quadratic_cost.h"

namespace stilt::ocp {
namespace {

using model::kChain;
using model::kFeet;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;
using model::kStates;

/// A row over position and velocity of a foot along one axis, and what that makes of the angles of its chain
/// and their rates: curvature c, slope g of 1/2 c (kp p + kd v + ...)^2.
struct FootRow {
  double by_position;
  double by_velocity;
  Batch curvature;
  Batch slope;
};

/// Foot rows of one axis of one foot, summed.
void add_foot_rows(const FootRow* rows, int count, int foot, int axis,
                   const model::NodeDerivatives<Batch>& node, QuadraticCost& out) noexcept {
  const Batch(&p)[kChain] = node.foot_position_dchain[2 * foot + axis];
  const Batch(&d)[kChain] = node.foot_velocity_dchain[2 * foot + axis];
  const int* chain = model::kChainAngles[foot];
  const int velocity = kVelocityColumn + axis;
  // Over (p, v): the 2 x 2 Hessian and the gradient.
  Batch pp = Batch(0.0), pv = Batch(0.0), vv = Batch(0.0), gp = Batch(0.0), gv = Batch(0.0);
  for (int r = 0; r < count; ++r) {
    const Batch of_position = rows[r].by_position * rows[r].curvature;
    const Batch of_velocity = rows[r].by_velocity * rows[r].curvature;
    pp += rows[r].by_position * of_position;
    pv += rows[r].by_position * of_velocity;
    vv += rows[r].by_velocity * of_velocity;
    gp += rows[r].by_position * rows[r].slope;
    gv += rows[r].by_velocity * rows[r].slope;
  }
  out.base_gradient[axis] += gp;
  out.base_curvature[axis] += pp;
  out.base_by_state[axis][velocity] += pv;
  out.g[velocity] += gv;
  out.H[velocity][velocity] += vv;
  for (int i = 0; i < kChain; ++i) {
    const int theta = kThetaColumn + chain[i];
    const int omega = kOmegaColumn + chain[i];
    // theta moves p by p_i and v by d_i, omega moves v by p_i.
    const Batch p_theta = pp * p[i] + pv * d[i];
    const Batch v_theta = pv * p[i] + vv * d[i];
    const Batch p_omega = pv * p[i];
    const Batch v_omega = vv * p[i];
    out.base_by_state[axis][theta] += p_theta;
    out.base_by_state[axis][omega] += p_omega;
    out.g[theta] += gp * p[i] + gv * d[i];
    out.g[omega] += gv * p[i];
    out.H[velocity][theta] += v_theta;
    out.H[omega][velocity] += v_omega;
    for (int j = 0; j < kChain; ++j) {
      out.H[omega][kThetaColumn + chain[j]] += p_omega * p[j] + v_omega * d[j];
      if (j > i) continue;
      out.H[theta][kThetaColumn + chain[j]] += p_theta * p[j] + v_theta * d[j];
      out.H[omega][kOmegaColumn + chain[j]] += v_omega * p[j];
    }
  }
}

void add_feet(const ProblemData& data, const StageBatch& batch, const model::NodeDerivatives<Batch>& node,
              QuadraticCost& out) noexcept {
  const Batch h = batch.duration;
  const Batch position_weight = h * data.cost.foot_position;
  const Batch velocity_weight = h * data.cost.foot_velocity;
  const Batch acceleration_weight = h * data.cost.foot_acceleration;
  const EqualityParameters& p = data.equality;
  for (int foot = 0; foot < kFeet; ++foot) {
    const bool stance = batch.mode[foot];
    for (int axis = 0; axis < 2; ++axis) {
      const int i = 2 * foot + axis;
      const Batch position_error = node.foot_position[i] - batch.foot_position_ref[i];
      const Batch velocity_error = node.foot_velocity[i] - batch.foot_velocity_ref[i];
      FootRow rows[3] = {{1.0, 0.0, position_weight, position_weight * position_error},
                         {0.0, 1.0, velocity_weight, velocity_weight * velocity_error}};
      const bool constrained = stance || axis == 1;
      if (constrained) {
        // On the constraint the acceleration's error is -e; the step onto it takes away the residual.
        const Batch error = node.foot_acceleration[i] - batch.foot_acceleration_ref[i];
        const double kd = stance ? p.stance_kd_1_s : p.swing_kd_1_s;
        const double kp = stance ? 0.0 : p.swing_kp_1_s2;
        const Batch e = stance ? kd * node.foot_velocity[i] + batch.foot_acceleration_ref[i]
                               : kd * velocity_error + kp * position_error;
        rows[2] = {kp, kd, acceleration_weight, acceleration_weight * e};
        out.drift -= acceleration_weight * error * (error + e);
      }
      add_foot_rows(rows, constrained ? 3 : 2, foot, axis, node, out);
    }
  }
}

}  // namespace

void add_state_terms(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                     const model::NodeDerivatives<Batch>& node, QuadraticCost& out) noexcept {
  const Batch h = batch.duration;
  for (int axis = 0; axis < 2; ++axis) {
    const Batch weight = h * data.state_weight[axis];
    out.base_gradient[axis] = weight * (it.x[axis] - batch.x_ref[axis]);
    out.base_curvature[axis] = weight;
    for (Batch& entry : out.base_by_state[axis]) entry = Batch(0.0);
  }
  for (int c = 0; c < kStateColumns; ++c) {
    const int i = kFirstAngle + c;
    const Batch weight = h * data.state_weight[i];
    out.g[c] += weight * (it.x[i] - batch.x_ref[i]);
    out.H[c][c] += weight;
  }
  for (int j = 0; j < kJoints; ++j) {
    const int q = kFirstJoint + j;
    const BarrierSlope position =
        limit_slope(data.inequality.joint_position, it.x[q], data.limits.position_min_rad[j],
                    data.limits.position_max_rad[j]);
    const double limit = data.limits.velocity_rad_s[j];
    const BarrierSlope velocity =
        limit_slope(data.inequality.joint_velocity, it.x[kPositions + q], -limit, limit);
    const int theta = kThetaColumn + 1 + j;
    const int omega = kOmegaColumn + 1 + j;
    out.g[theta] += h * position.first;
    out.H[theta][theta] += h * position.second;
    out.g[omega] += h * velocity.first;
    out.H[omega][omega] += h * velocity.second;
  }
  add_feet(data, batch, node, out);
}

}  // namespace stilt::ocp
