#pragma once

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

  /// The first stance foot's force, combined: by_x fx + by_z fz.
  void add_force(const Batch& slope, const Batch& curvature, double by_x, const Batch& by_z) noexcept {
    for (int c = 0; c < Mode::kColumns; ++c) {
      rows_[count_][c] = by_x * force_.slope[0][c] + by_z * force_.slope[1][c];
    }
    finish(slope, curvature, by_x * force_.constant[0] + by_z * force_.constant[1]);
  }

  /// Sums gradient and lower half of the Hessian over all rows, in blocks of 4 x 2 that stay in registers.
  void accumulate(QuadraticCost& out) const noexcept {
    for (int c = 0; c < kColumns; ++c) {
      Batch sum = slope_[0] * rows_[0][c];
      for (int r = 1; r < kRows; ++r) sum += slope_[r] * rows_[r][c];
      out.g[c] = sum;
    }
    for (int i = 0; i < kColumns; i += 4) {
      for (int j = 0; j < i + 4; j += 2) {
        Batch sum[4][2] = {};
        for (int r = 0; r < kRows; ++r) {
          const Batch b0 = weighted_[r][j];
          const Batch b1 = weighted_[r][j + 1];
          for (int k = 0; k < 4; ++k) {
            const Batch a = rows_[r][i + k];
            sum[k][0] += a * b0;
            sum[k][1] += a * b1;
          }
        }
        for (int k = 0; k < 4; ++k) {
          out.H[i + k][j] = sum[k][0];
          out.H[i + k][j + 1] = sum[k][1];
        }
      }
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
    rows.add_force(cost.gx, cost.hxx, 1.0, l);
    rows.add_force(cost.gz - l * cost.gx, cost.hzz - l * cost.hxz, 0.0, Batch(1.0));
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

/// Terms of the state: weights, joint limits, positions and velocities of the feet, and their accelerations
/// as far as constraints fix them. Adds to H, g and drift; sets the terms of x_b and z_b.
void add_state_terms(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                     const model::NodeDerivatives<Batch>& node, QuadraticCost& out) noexcept;

}  // namespace stilt::ocp
