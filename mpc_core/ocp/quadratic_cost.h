#pragma once

#include "mpc_core/ocp/barrier.h"
#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/cost_rows.h"
#include "mpc_core/ocp/torque_limit.h"

/// Gauss-Newton cost of a batch over (dx, w) after projection of the equality constraints, times the duration
/// of the stage.
///
/// Every term is 1/2 c (rho + r d)^2 up to a constant, with r the row of a quantity over d = (dz_b, dx, w). A
/// barrier has its own slope g and curvature c. Swing forces, the first stance force and z are substituted in
/// the row, so that the sum over the rows is the stage's Hessian. Only joint torques, the swing foot's
/// horizontal acceleration, the stance force and the weights of z are rows. Accelerations fixed by a
/// constraint need none: the linearised constraint gives them as functions of the state alone,
///   a = -kd v   or   a - a_ref = -kd (v - v_ref) - kp (p - p_ref).
/// Gradients are those on the constraints, at dx = 0 and w = 0.
namespace stilt::ocp {

/// The barriers of a flow.
struct BarrierCurves {
  BarrierCurve friction, joint_torque, joint_position, joint_velocity;

  explicit BarrierCurves(const InequalityParameters& p) noexcept
      : friction(p.friction),
        joint_torque(p.joint_torque),
        joint_position(p.joint_position),
        joint_velocity(p.joint_velocity) {}
};

/// Slope and Hessian of weight and friction cone over the force (fx, fz) of a stance foot.
struct ForceCost {
  Batch gx, gz, hxx, hxz, hzz;

  ForceCost(const ProblemData& data, const BarrierCurve& friction, const StageBatch& batch, const Batch* u,
            int foot) noexcept {
    const int x = model::kJoints + 2 * foot;
    const int z = x + 1;
    const double mu = data.inequality.friction_coefficient;
    const Batch margin = mu * (u[z] - data.minimum_normal_force_N(batch.mode));
    const BarrierPair cone(friction, margin - u[x], margin + u[x]);
    const Batch h = batch.duration;
    gx = h * (data.input_weight[x] * (u[x] - batch.u_ref[x]) + cone.b.first - cone.a.first);
    gz = h * (data.input_weight[z] * (u[z] - batch.u_ref[z]) + mu * (cone.b.first + cone.a.first));
    hxx = h * (data.input_weight[x] + cone.b.second + cone.a.second);
    hxz = h * mu * (cone.b.second - cone.a.second);
    hzz = h * (data.input_weight[z] + mu * mu * (cone.b.second + cone.a.second));
  }
};

/// Weights of the joint accelerations when one constraint remains. All are equal (set_weights), so that the
/// orthogonal directions Y and W_k decouple. The cost of Y c is one row of c, the cost of w is diagonal.
template <class Mode>
class UniformWeights {
 public:
  UniformWeights(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                 const ConstraintElimination<Mode>& constraint) noexcept
      : constraint_(constraint), weight_(batch.duration * data.input_weight[0]) {
    for (int j = 0; j < model::kJoints; ++j) slope_[j] = weight_ * (it.u[j] - batch.u_ref[j]);
  }

  void add_constraint(DenseRows<Mode>& rows) const noexcept {
    const Batch* Y = constraint_.Y[0];
    rows.add_constraint({over_variables<Mode>(slope_, Y) + weight_ * over_variables<Mode>(constraint_.z0, Y),
                         weight_ * over_variables<Mode>(Y, Y)});
  }

  void add_free(QuadraticCost& out) const noexcept {
    for (int k = 0; k < Mode::kFree; ++k) {
      out.g[kFirstFree + k] += over_variables<Mode>(slope_, constraint_.W[k]);
      out.H[kFirstFree + k][kFirstFree + k] += weight_;
    }
    out.constraint_step_slope += over_variables<Mode>(slope_, constraint_.z0);
  }

 private:
  const ConstraintElimination<Mode>& constraint_;
  Batch weight_;
  Batch slope_[model::kJoints];
};

/// Adds the weights of z, one row each: joint accelerations, in double support the second foot's force.
template <class Mode>
void add_variables(const ProblemData& data, const BarrierCurve& friction, const StageBatch& batch,
                   const BatchIterate& it, DenseRows<Mode>& rows) noexcept {
  using model::kJoints;
  for (int j = 0; j < kJoints; ++j) {
    const Batch weight = batch.duration * data.input_weight[j];
    Batch by_z[Mode::kVariables] = {};
    by_z[j] = Batch(1.0);
    rows.add_variables({weight * (it.u[j] - batch.u_ref[j]), weight}, by_z);
  }
  if constexpr (Mode::kStanceFeet == 2) {
    const ForceCost cost(data, friction, batch, it.u, 1);
    const Batch l = cost.hxz / cost.hxx;
    Batch by_z[Mode::kVariables] = {};
    by_z[kJoints] = Batch(1.0);
    by_z[kJoints + 1] = l;
    rows.add_variables({cost.gx, cost.hxx}, by_z);
    by_z[kJoints] = Batch(0.0);
    by_z[kJoints + 1] = Batch(1.0);
    rows.add_variables({cost.gz - l * cost.gx, cost.hzz - l * cost.hxz}, by_z);
  }
}

/// Computes the terms of the inputs. Sets H, g and constraint_step_slope.
template <class Mode>
void add_input_terms(const ProblemData& data, const BarrierCurves& barriers, const StageBatch& batch,
                     const BatchIterate& it, const model::NodeDerivatives<Batch>& node,
                     const ForceElimination<Mode>& force, const ConstraintElimination<Mode>& constraint,
                     QuadraticCost& out) noexcept {
  using model::kJoints;
  const Batch h = batch.duration;
  // All terms before the first row: their divisions and roots take as long as several rows.
  const Batch acceleration_weight = h * data.cost.foot_acceleration;
  UnitTerm acceleration[model::kFeet];
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (Mode::stance(foot)) continue;
    const int i = 2 * foot;
    acceleration[foot] =
        UnitTerm(acceleration_weight * (node.foot_acceleration[i] - batch.foot_acceleration_ref[i]),
                 acceleration_weight);
  }
  TorqueLimitCost limit[kJoints];
  UnitTerm torque[kJoints];
  for (int j = 0; j < kJoints; ++j) {
    limit[j] = TorqueLimitCost(barriers.joint_torque, data.limits, j, node.joint_torque[j],
                               it.x[model::kPositions + model::kFirstJoint + j]);
    torque[j] = UnitTerm(h * limit[j].combined.first, h * limit[j].combined.second);
  }
  // H = [1 l; 0 1]' diag(hxx, hzz - l hxz) [1 l; 0 1] of the stance force: two rows.
  UnitTerm combined_force, vertical_force;
  Batch l;
  if constexpr (Mode::kStanceFeet > 0) {
    const ForceCost cost(data, barriers.friction, batch, it.u, Mode::kFirstStance);
    l = cost.hxz / cost.hxx;
    combined_force = UnitTerm(cost.gx, cost.hxx);
    vertical_force = UnitTerm(cost.gz - l * cost.gx, cost.hzz - l * cost.hxz);
  }

  DenseRows<Mode> rows(force, constraint);
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (Mode::stance(foot)) continue;
    const int i = 2 * foot;
    rows.add(acceleration[foot], {node.foot_acceleration_dtheta[i], node.foot_acceleration_domega[i],
                                  node.foot_acceleration_du[i]});
  }
  for (int j = 0; j < kJoints; ++j) {
    rows.add(torque[j], {node.joint_torque_dtheta[j], node.joint_torque_domega[j], node.joint_torque_du[j]},
             j, limit[j].by_velocity);
  }
  if constexpr (Mode::kStanceFeet > 0) {
    rows.add_force(combined_force, l);
    rows.add_vertical_force(vertical_force);
  }
  if constexpr (DenseRows<Mode>::kUniform) {
    const UniformWeights<Mode> weights(data, batch, it, constraint);
    weights.add_constraint(rows);
    rows.accumulate(out);
    weights.add_free(out);
  } else {
    add_variables(data, barriers.friction, batch, it, rows);
    rows.accumulate(out);
  }
  for (int j = 0; j < kJoints; ++j) {
    const int column = kFirstStateColumn + kOmegaColumn + kFirstJointAngle + j;
    out.g[column] += h * limit[j].velocity.first;
    out.H[column][column] += h * limit[j].velocity.second;
  }
  for (int i = 0; i < 2 * model::kFeet; ++i) {
    if (Mode::stance(i / 2)) continue;
    const int input = kJoints + i;
    out.constraint_step_slope +=
        h * data.input_weight[input] * (it.u[input] - batch.u_ref[input]) * force.swing_step[i];
  }
}

/// Cost of one foot along one axis over its position p and velocity v: the curvatures and the gradient.
struct FootCost {
  Batch pp, pv, vv, gp, gv;
};

/// Position, velocity, and the acceleration when a constraint fixes it (all but a swing foot's x). There
///   a - a_ref = -(kd dv + kp dp + e),
/// and the step onto the constraint removes the residual, which is error + e.
template <bool stance, int axis>
STILT_INLINE inline FootCost foot_cost(const ProblemData& data, const StageBatch& batch,
                                       const model::NodeDerivatives<Batch>& node, int foot,
                                       Batch& constraint_step_slope) noexcept {
  const int i = 2 * foot + axis;
  const Batch h = batch.duration;
  const Batch position_error = node.foot_position[i] - batch.foot_position_ref[i];
  const Batch velocity_error = node.foot_velocity[i] - batch.foot_velocity_ref[i];
  FootCost cost;
  cost.pp = h * data.cost.foot_position;
  cost.vv = h * data.cost.foot_velocity;
  cost.gp = cost.pp * position_error;
  cost.gv = cost.vv * velocity_error;
  if constexpr (stance || axis == 1) {
    const Batch weight = h * data.cost.foot_acceleration;
    const Batch error = node.foot_acceleration[i] - batch.foot_acceleration_ref[i];
    const double kd = stance ? data.equality.stance_kd_1_s : data.equality.swing_kd_1_s;
    Batch e = stance ? kd * node.foot_velocity[i] + batch.foot_acceleration_ref[i] : kd * velocity_error;
    if constexpr (!stance) {
      const double kp = data.equality.swing_kp_1_s2;
      e += kp * position_error;
      cost.pp += weight * (kp * kp);
      cost.pv = weight * (kp * kd);
      cost.gp += weight * kp * e;
    }
    cost.vv += weight * (kd * kd);
    cost.gv += weight * kd * e;
    constraint_step_slope -= weight * error * (error + e);
  }
  return cost;
}

/// Columns of link i of a foot's chain.
template <int foot>
constexpr int theta_column(int i) noexcept {
  return kFirstStateColumn + kThetaColumn + model::kChainAngles[foot][i];
}
template <int foot>
constexpr int omega_column(int i) noexcept {
  return kFirstStateColumn + kOmegaColumn + model::kChainAngles[foot][i];
}

/// Column of the velocity of the base along an axis.
constexpr int velocity_column(int axis) noexcept { return kFirstStateColumn + kVelocityColumn + axis; }

/// Adds both axes of one foot. p_i: derivative of a position by angle i of the chain, and of the velocity by
/// that angle's rate. d_i: derivative of the velocity by the angle. theta_i moves (p, v) by (p_i, d_i),
/// omega_i by (0, p_i), the base by (1, 0) and (0, 1).
template <class Mode, int foot>
STILT_INLINE inline void add_foot(const ProblemData& data, const StageBatch& batch,
                                  const model::NodeDerivatives<Batch>& node, QuadraticCost& out) noexcept {
  using model::kChain;
  constexpr bool kStance = Mode::stance(foot);
  const FootCost costs[2] = {foot_cost<kStance, 0>(data, batch, node, foot, out.constraint_step_slope),
                             foot_cost<kStance, 1>(data, batch, node, foot, out.constraint_step_slope)};
  constexpr auto couples = [](int axis) { return !kStance && axis == 1; };  // p with v: swing height only
  out.x_gradient += costs[0].gp;
  out.x_curvature += costs[0].pp;
  out.g[kHeightColumn] += costs[1].gp;
  out.H[kHeightColumn][kHeightColumn] += costs[1].pp;
  lq::unroll<2>([&](auto axis) STILT_INLINE {
    out.g[velocity_column(axis)] += costs[axis].gv;
    out.H[velocity_column(axis)][velocity_column(axis)] += costs[axis].vv;
    if constexpr (couples(axis)) out.H[velocity_column(axis)][kHeightColumn] += costs[axis].pv;
  });
  // Both axes of a link before the next link: its sums stay in registers.
  lq::unroll<kChain>([&](auto i) STILT_INLINE {
    constexpr int kTheta = theta_column<foot>(i);
    constexpr int kOmega = omega_column<foot>(i);
    Batch theta_theta[kChain], omega_theta[kChain], omega_omega[kChain];
    Batch theta_gradient, omega_gradient;
    lq::unroll<2>([&](auto axis_constant) STILT_INLINE {
      constexpr int axis = axis_constant;
      const FootCost& cost = costs[axis];
      const Batch(&p)[kChain] = node.foot_position_dchain[2 * foot + axis];
      const Batch(&d)[kChain] = node.foot_velocity_dchain[2 * foot + axis];
      const auto add = [](Batch& sum, const Batch& value) STILT_INLINE {
        if constexpr (axis == 0) {
          sum = value;
        } else {
          sum += value;
        }
      };
      Batch p_theta = cost.pp * p[i];
      Batch v_theta = cost.vv * d[i];
      const Batch v_omega = cost.vv * p[i];
      if constexpr (couples(axis)) {
        p_theta += cost.pv * d[i];
        v_theta += cost.pv * p[i];
        out.H[kOmega][kHeightColumn] += cost.pv * p[i];
      }
      if constexpr (axis == 0) {
        out.x_by_theta[model::kChainAngles[foot][i]] += p_theta;
      } else {
        out.H[kTheta][kHeightColumn] += p_theta;
      }
      out.H[velocity_column(axis)][kTheta] += v_theta;
      out.H[kOmega][velocity_column(axis)] += v_omega;
      add(theta_gradient, cost.gp * p[i] + cost.gv * d[i]);
      add(omega_gradient, cost.gv * p[i]);
      lq::unroll<kChain>([&](auto j) STILT_INLINE {
        add(omega_theta[j], v_omega * d[j]);
        if constexpr (couples(axis)) omega_theta[j] += (cost.pv * p[i]) * p[j];
        if constexpr (j <= i) {
          add(theta_theta[j], p_theta * p[j] + v_theta * d[j]);
          add(omega_omega[j], v_omega * p[j]);
        }
      });
    });
    out.g[kTheta] += theta_gradient;
    out.g[kOmega] += omega_gradient;
    lq::unroll<kChain>([&](auto j) STILT_INLINE {
      constexpr int kTheta_j = theta_column<foot>(j);
      constexpr int kOmega_j = omega_column<foot>(j);
      out.H[kOmega][kTheta_j] += omega_theta[j];
      if constexpr (j <= i) {
        out.H[kTheta][kTheta_j] += theta_theta[j];
        out.H[kOmega][kOmega_j] += omega_omega[j];
      }
    });
  });
}

/// Adds the terms of the state: weights, joint limits, positions and velocities of the feet, and
/// accelerations of the feet where constraints fix them. Adds to H, g and constraint_step_slope; sets the
/// terms of x_b.
template <class Mode>
void add_state_terms(const ProblemData& data, const BarrierCurves& barriers, const StageBatch& batch,
                     const BatchIterate& it, const model::NodeDerivatives<Batch>& node,
                     QuadraticCost& out) noexcept {
  using model::kPositions;
  const Batch h = batch.duration;
  out.x_curvature = h * data.state_weight[0];
  out.x_gradient = out.x_curvature * (it.x[0] - batch.x_ref[0]);
  lq::unroll<model::kAngles>([&](auto i) STILT_INLINE { out.x_by_theta[i] = Batch(0.0); });
  const Batch height_weight = h * data.state_weight[1];
  out.H[kHeightColumn][kHeightColumn] += height_weight;
  out.g[kHeightColumn] += height_weight * (it.x[1] - batch.x_ref[1]);
  lq::unroll<kStateColumns>([&](auto c) STILT_INLINE {
    constexpr int i = model::kFirstAngle + c;
    constexpr int kJoint = c < kVelocityColumn ? c - kThetaColumn - 1 : c - kOmegaColumn - 1;
    Batch slope = data.state_weight[i] * (it.x[i] - batch.x_ref[i]);
    Batch curvature = Batch(data.state_weight[i]);
    if constexpr (kJoint >= 0) {
      const bool is_position = c < kVelocityColumn;
      const JointLimits& limits = data.limits;
      const BarrierSlope barrier =
          is_position ? limit_slope(barriers.joint_position, it.x[i], limits.position_min_rad[kJoint],
                                    limits.position_max_rad[kJoint])
                      : limit_slope(barriers.joint_velocity, it.x[i], -limits.velocity_rad_s[kJoint],
                                    limits.velocity_rad_s[kJoint]);
      slope += barrier.first;
      curvature += barrier.second;
    }
    constexpr int kColumn = kFirstStateColumn + c;
    out.g[kColumn] += h * slope;
    out.H[kColumn][kColumn] += h * curvature;
  });
  add_foot<Mode, 0>(data, batch, node, out);
  add_foot<Mode, 1>(data, batch, node, out);
}

}  // namespace stilt::ocp
