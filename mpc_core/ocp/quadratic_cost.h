#pragma once

#include <algorithm>

#include "mpc_core/ocp/barrier.h"
#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/projection.h"

/// Gauss-Newton cost of a batch over (dx, z), times the duration of the stage.
///
/// Every term is 1/2 c (rho + r dx')^2 up to a constant (a barrier brings its own slope g and curvature c).
/// Swing forces and the first stance force are substituted; z stays, so that joint accelerations are
/// variables of their own and only joint torques, the swing foot's horizontal acceleration and the stance
/// force are dense rows. The accelerations that a constraint fixes need no dense row either: for every step
/// that fulfils the linearised constraint a = -kd v or a - a_ref = -kd (v - v_ref) - kp (p - p_ref), which
/// depends on the state alone. Gradients are those at dx = 0 and z = z0, on the constraints.
namespace stilt::ocp {

/// Rows of H are padded to whole blocks of four.
inline constexpr int kPaddedColumns = (kMaxColumns + 3) / 4 * 4;

/// 1/2 d' H d + g' d over d = (theta, v, omega, z), and the terms of x_b and z_b, which meet theta and, for
/// z_b, v and omega alone.
struct QuadraticCost {
  Batch H[kPaddedColumns][kPaddedColumns];  ///< lower half
  Batch g[kPaddedColumns];
  Batch base_gradient[2];
  Batch base_curvature[2];
  Batch base_by_state[2][kStateColumns];  ///< of x_b only the theta part is set
  Batch drift;  ///< first-order change of the cost along the step onto the constraints
};

/// Rows that are dense over (dx, z), each with slope and curvature.
template <class Mode>
class DenseRows {
 public:
  /// Joint torques, the unconstrained acceleration of each swing foot, two for the first stance force.
  static constexpr int kRows =
      model::kJoints + (model::kFeet - Mode::kStanceFeet) + (Mode::kStanceFeet > 0 ? 2 : 0);
  static constexpr int kColumns = (Mode::kColumns + 3) / 4 * 4;

  DenseRows(const ForceElimination<Mode>& force, const ConstraintElimination<Mode>& constraint) noexcept
      : force_(force), constraint_(constraint) {}

  /// A quantity given by its derivatives.
  void add(const Batch& slope, const Batch& curvature, const Slopes& by) noexcept {
    finish(slope, curvature, force_.substitute(by, rows_[count_]));
  }

  /// The first stance foot's force, combined: fx + by_z fz.
  void add_force(const Batch& slope, const Batch& curvature, const Batch& by_z) noexcept {
    for (int c = 0; c < Mode::kColumns; ++c)
      rows_[count_][c] = force_.slope[0][c] + by_z * force_.slope[1][c];
    finish(slope, curvature, force_.constant[0] + by_z * force_.constant[1]);
  }

  /// The vertical force alone.
  void add_vertical_force(const Batch& slope, const Batch& curvature) noexcept {
    std::copy(force_.slope[1], force_.slope[1] + Mode::kColumns, rows_[count_]);
    finish(slope, curvature, force_.constant[1]);
  }

  /// Sums gradient and lower half of the Hessian over all rows, in blocks of 4 x 2 that stay in registers (of
  /// the block whose upper half lies above the diagonal, the lower half).
  void accumulate(QuadraticCost& out) const noexcept {
    for (int c = 0; c < kColumns; ++c) {
      Batch sum = slope_[0] * rows_[0][c];
      for (int r = 1; r < kRows; ++r) sum += slope_[r] * rows_[r][c];
      out.g[c] = sum;
    }
    for (int i = 0; i < kColumns; i += 4) {
      for (int j = 0; j <= i; j += 2) block<0>(i, j, out);
      block<2>(i, i + 2, out);
    }
    out.drift = drift_;
  }

 private:
  /// `step`: of the quantity at dx = 0, z = 0; that of z0 is added here.
  void finish(const Batch& slope, const Batch& curvature, Batch step) noexcept {
    Batch* row = rows_[count_];
    for (int v = 0; v < Mode::kVariables; ++v) step += row[kStateColumns + v] * constraint_.z0[v];
    for (int c = Mode::kColumns; c < kColumns; ++c) row[c] = Batch(0.0);
    for (int c = 0; c < kColumns; ++c) weighted_[count_][c] = curvature * row[c];
    drift_ += slope * step;
    slope_[count_++] = slope + curvature * step;
  }

  /// Entries (i + first ... i + 3) x (j, j + 1) of the Hessian.
  template <int first>
  STILT_INLINE void block(int i, int j, QuadraticCost& out) const noexcept {
    Batch sum[4][2] = {};
    for (int r = 0; r < kRows; ++r) {
      const Batch b0 = weighted_[r][j];
      const Batch b1 = weighted_[r][j + 1];
      for (int k = first; k < 4; ++k) {
        const Batch a = rows_[r][i + k];
        sum[k][0] += a * b0;
        sum[k][1] += a * b1;
      }
    }
    for (int k = first; k < 4; ++k) {
      out.H[i + k][j] = sum[k][0];
      out.H[i + k][j + 1] = sum[k][1];
    }
  }

  const ForceElimination<Mode>& force_;
  const ConstraintElimination<Mode>& constraint_;
  int count_ = 0;
  Batch rows_[kRows][kColumns];
  Batch weighted_[kRows][kColumns];
  Batch slope_[kRows];
  Batch drift_ = Batch(0.0);
};

/// Slope and Hessian of weight and friction cone over the force (fx, fz) of a stance foot.
struct ForceCost {
  Batch gx, gz, hxx, hxz, hzz;

  ForceCost(const ProblemData& data, const StageBatch& batch, const Batch* u, int foot) noexcept {
    const int x = model::kJoints + 2 * foot;
    const int z = x + 1;
    const InequalityParameters& p = data.inequality;
    const double mu = p.friction_coefficient;
    const Batch margin = mu * (u[z] - p.minimum_normal_force_N);
    const BarrierPair cone(p.friction, margin - u[x], margin + u[x]);
    const Batch h = batch.duration;
    gx = h * (data.input_weight[x] * (u[x] - batch.u_ref[x]) + cone.b.first - cone.a.first);
    gz = h * (data.input_weight[z] * (u[z] - batch.u_ref[z]) + mu * (cone.b.first + cone.a.first));
    hxx = h * (data.input_weight[x] + cone.b.second + cone.a.second);
    hxz = h * mu * (cone.b.second - cone.a.second);
    hzz = h * (data.input_weight[z] + mu * mu * (cone.b.second + cone.a.second));
  }
};

/// Terms of the inputs: dense rows, then what acts on z itself. Sets H, g and drift.
template <class Mode>
void add_input_terms(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                     const model::NodeDerivatives<Batch>& node, const ForceElimination<Mode>& force,
                     const ConstraintElimination<Mode>& constraint, QuadraticCost& out) noexcept {
  using model::kJoints;
  const Batch h = batch.duration;
  DenseRows<Mode> rows(force, constraint);
  for (int j = 0; j < kJoints; ++j) {
    const double limit = data.limits.torque_Nm[j];
    const BarrierSlope barrier =
        limit_slope(data.inequality.joint_torque, node.joint_torque[j], -limit, limit);
    rows.add(h * barrier.first, h * barrier.second,
             {node.joint_torque_dtheta[j], node.joint_torque_domega[j], node.joint_torque_du[j]});
  }
  const Batch acceleration_weight = h * data.cost.foot_acceleration;
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (Mode::stance(foot)) continue;
    const int i = 2 * foot;
    rows.add(
        acceleration_weight * (node.foot_acceleration[i] - batch.foot_acceleration_ref[i]),
        acceleration_weight,
        {node.foot_acceleration_dtheta[i], node.foot_acceleration_domega[i], node.foot_acceleration_du[i]});
  }
  if constexpr (Mode::kStanceFeet > 0) {
    // H = [1 l; 0 1]' diag(hxx, hzz - l hxz) [1 l; 0 1]: two rows.
    const ForceCost cost(data, batch, it.u, Mode::kFirstStance);
    const Batch l = cost.hxz / cost.hxx;
    rows.add_force(cost.gx, cost.hxx, l);
    rows.add_vertical_force(cost.gz - l * cost.gx, cost.hzz - l * cost.hxz);
  }
  rows.accumulate(out);

  for (int j = 0; j < kJoints; ++j) {
    const int v = kStateColumns + j;
    const Batch weight = h * data.input_weight[j];
    const Batch slope = weight * (it.u[j] - batch.u_ref[j]);
    out.H[v][v] += weight;
    out.g[v] += slope + weight * constraint.z0[j];
    out.drift += slope * constraint.z0[j];
  }
  if constexpr (Mode::kStanceFeet == 2) {
    const ForceCost cost(data, batch, it.u, 1);
    const int x = kStateColumns + kJoints;
    const Batch& x0 = constraint.z0[kJoints];
    const Batch& z0 = constraint.z0[kJoints + 1];
    out.H[x][x] += cost.hxx;
    out.H[x + 1][x] += cost.hxz;
    out.H[x + 1][x + 1] += cost.hzz;
    out.g[x] += cost.gx + cost.hxx * x0 + cost.hxz * z0;
    out.g[x + 1] += cost.gz + cost.hxz * x0 + cost.hzz * z0;
    out.drift += cost.gx * x0 + cost.gz * z0;
  }
  for (int i = 0; i < 2 * model::kFeet; ++i) {
    if (Mode::stance(i / 2)) continue;
    const int input = kJoints + i;
    out.drift += h * data.input_weight[input] * (it.u[input] - batch.u_ref[input]) * force.swing_step[i];
  }
}

/// Cost of one foot along one axis over its position p and velocity v: the curvatures and the gradient.
struct FootCost {
  Batch pp, pv, vv, gp, gv;
};

/// Position, velocity, and the acceleration as far as a constraint fixes it (all but a swing foot's x): there
/// a - a_ref = -(kd dv + kp dp + e), and the step onto the constraint takes away the residual, error + e.
template <bool stance, int axis>
STILT_INLINE inline FootCost foot_cost(const ProblemData& data, const StageBatch& batch,
                                       const model::NodeDerivatives<Batch>& node, int foot,
                                       Batch& drift) noexcept {
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
    drift -= weight * error * (error + e);
  }
  return cost;
}

/// Both axes of one foot. With p_i the derivative of a position by angle i of the chain (and of the velocity
/// by its rate), d_i that of the velocity by the angle: theta_i moves (p, v) by (p_i, d_i), omega_i by
/// (0, p_i), the base by (1, 0) and (0, 1).
template <class Mode, int foot>
STILT_INLINE inline void add_foot(const ProblemData& data, const StageBatch& batch,
                                  const model::NodeDerivatives<Batch>& node, QuadraticCost& out) noexcept {
  using model::kChain;
  constexpr bool kStance = Mode::stance(foot);
  Batch theta_theta[kChain][kChain], omega_theta[kChain][kChain], omega_omega[kChain][kChain];
  Batch theta_gradient[kChain], omega_gradient[kChain];
  solver::unroll<2>([&](auto axis_constant) STILT_INLINE {
    constexpr int axis = axis_constant;
    constexpr bool kCoupled = !kStance && axis == 1;  // p and v meet in the swing foot's height alone
    const FootCost cost = foot_cost<kStance, axis>(data, batch, node, foot, out.drift);
    const Batch(&p)[kChain] = node.foot_position_dchain[2 * foot + axis];
    const Batch(&d)[kChain] = node.foot_velocity_dchain[2 * foot + axis];
    constexpr int kVelocity = kVelocityColumn + axis;
    out.base_gradient[axis] += cost.gp;
    out.base_curvature[axis] += cost.pp;
    out.g[kVelocity] += cost.gv;
    out.H[kVelocity][kVelocity] += cost.vv;
    if constexpr (kCoupled) out.base_by_state[axis][kVelocity] += cost.pv;
    const auto add = [](Batch& sum, const Batch& value) STILT_INLINE {
      if constexpr (axis == 0) {
        sum = value;
      } else {
        sum += value;
      }
    };
    solver::unroll<kChain>([&](auto i) STILT_INLINE {
      constexpr int kTheta = kThetaColumn + model::kChainAngles[foot][i];
      constexpr int kOmega = kOmegaColumn + model::kChainAngles[foot][i];
      Batch p_theta = cost.pp * p[i];
      Batch v_theta = cost.vv * d[i];
      const Batch v_omega = cost.vv * p[i];
      if constexpr (kCoupled) {
        p_theta += cost.pv * d[i];
        v_theta += cost.pv * p[i];
        out.base_by_state[axis][kOmega] += cost.pv * p[i];
      }
      out.base_by_state[axis][kTheta] += p_theta;
      out.H[kVelocity][kTheta] += v_theta;
      out.H[kOmega][kVelocity] += v_omega;
      add(theta_gradient[i], cost.gp * p[i] + cost.gv * d[i]);
      add(omega_gradient[i], cost.gv * p[i]);
      solver::unroll<kChain>([&](auto j) STILT_INLINE {
        add(omega_theta[i][j], v_omega * d[j]);
        if constexpr (kCoupled) omega_theta[i][j] += (cost.pv * p[i]) * p[j];
        if constexpr (j <= i) {
          add(theta_theta[i][j], p_theta * p[j] + v_theta * d[j]);
          add(omega_omega[i][j], v_omega * p[j]);
        }
      });
    });
  });
  solver::unroll<kChain>([&](auto i) STILT_INLINE {
    constexpr int kTheta = kThetaColumn + model::kChainAngles[foot][i];
    constexpr int kOmega = kOmegaColumn + model::kChainAngles[foot][i];
    out.g[kTheta] += theta_gradient[i];
    out.g[kOmega] += omega_gradient[i];
    solver::unroll<kChain>([&](auto j) STILT_INLINE {
      constexpr int kTheta_j = kThetaColumn + model::kChainAngles[foot][j];
      constexpr int kOmega_j = kOmegaColumn + model::kChainAngles[foot][j];
      out.H[kOmega][kTheta_j] += omega_theta[i][j];
      if constexpr (j <= i) {
        out.H[kTheta][kTheta_j] += theta_theta[i][j];
        out.H[kOmega][kOmega_j] += omega_omega[i][j];
      }
    });
  });
}

/// Terms of the state: weights, joint limits, positions and velocities of the feet, and their accelerations
/// as far as constraints fix them. Adds to H, g and drift; sets the terms of x_b and z_b.
template <class Mode>
void add_state_terms(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                     const model::NodeDerivatives<Batch>& node, QuadraticCost& out) noexcept {
  using model::kPositions;
  const Batch h = batch.duration;
  for (int axis = 0; axis < 2; ++axis) {
    const Batch weight = h * data.state_weight[axis];
    out.base_gradient[axis] = weight * (it.x[axis] - batch.x_ref[axis]);
    out.base_curvature[axis] = weight;
    for (Batch& entry : out.base_by_state[axis]) entry = Batch(0.0);
  }
  solver::unroll<kStateColumns>([&](auto c) STILT_INLINE {
    constexpr int i = model::kFirstAngle + c;
    constexpr int kJoint = c < kVelocityColumn ? c - kThetaColumn - 1 : c - kOmegaColumn - 1;
    Batch slope = data.state_weight[i] * (it.x[i] - batch.x_ref[i]);
    Batch curvature = Batch(data.state_weight[i]);
    if constexpr (kJoint >= 0) {
      const bool is_position = c < kVelocityColumn;
      const JointLimits& limits = data.limits;
      const BarrierSlope barrier =
          is_position ? limit_slope(data.inequality.joint_position, it.x[i], limits.position_min_rad[kJoint],
                                    limits.position_max_rad[kJoint])
                      : limit_slope(data.inequality.joint_velocity, it.x[i], -limits.velocity_rad_s[kJoint],
                                    limits.velocity_rad_s[kJoint]);
      slope += barrier.first;
      curvature += barrier.second;
    }
    out.g[c] += h * slope;
    out.H[c][c] += h * curvature;
  });
  add_foot<Mode, 0>(data, batch, node, out);
  add_foot<Mode, 1>(data, batch, node, out);
}

}  // namespace stilt::ocp
