#pragma once

#include "mpc_core/ocp/barrier.h"
#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/projection.h"

/// Gauss-Newton cost of a batch in the projected variables (dx, w).
///
/// Every term is 1/2 c (rho + r_x dx + r_u du)^2 up to a constant: gradient g = c rho (a barrier brings its
/// own slope), curvature c, row [r_x, r_u]. With du = u0 + X dx + W w the row becomes [r_x + r_u X, r_u W]
/// and the gradient g + c r_u u0, after which the Hessian is a plain sum of c (row)'(row).
namespace stilt::ocp {

/// Rows that are dense in the state, over [states without x_b (13), free inputs (2 to 4)], padded to fours.
template <class Mode>
class DenseRows {
 public:
  /// Joint accelerations, joint torques, accelerations of both feet, two a stance foot's force.
  static constexpr int kMaxRows = 12 + 2 * Mode::kStanceFeet;
  static constexpr int kColumns = (kReducedStates + Mode::kFree + 3) / 4 * 4;

  explicit DenseRows(const Projection<Mode>& projection) noexcept : projection_(projection) {}

  /// Adds a row given by its derivatives; `dx` may be null for a row of inputs alone.
  void add(const Batch& gradient, const Batch& curvature, const Batch* dx,
           const Batch (&du)[model::kInputs]) noexcept {
    Batch shift = Batch(0.0);
    Batch(&row)[kColumns] = rows_[count_];
    for (int c = 0; c < kReducedStates; ++c) row[c] = dx != nullptr ? dx[c] : Batch(0.0);
    for (int c = kReducedStates; c < kColumns; ++c) row[c] = Batch(0.0);
    for (int i = 0; i < model::kInputs; ++i) {
      shift += du[i] * projection_.u0[i];
      if (i >= model::kJoints && !Mode::stance((i - model::kJoints) / 2)) continue;
      for (int c = 0; c < kReducedStates; ++c) row[c] += du[i] * projection_.X[i][c];
      for (int c = 0; c < Mode::kFree; ++c) row[kReducedStates + c] += du[i] * projection_.W[i][c];
    }
    drift_ += gradient * shift;
    finish(gradient + curvature * shift, curvature);
  }

  /// Adds a row that is one input, or a combination of two of them.
  void add_input(const Batch& gradient, const Batch& curvature, int i, const Batch& by_i, int j,
                 const Batch& by_j) noexcept {
    Batch(&row)[kColumns] = rows_[count_];
    for (int c = 0; c < kReducedStates; ++c) row[c] = by_i * projection_.X[i][c] + by_j * projection_.X[j][c];
    for (int c = kReducedStates; c < kColumns; ++c) row[c] = Batch(0.0);
    for (int c = 0; c < Mode::kFree; ++c) {
      row[kReducedStates + c] = by_i * projection_.W[i][c] + by_j * projection_.W[j][c];
    }
    const Batch shift = by_i * projection_.u0[i] + by_j * projection_.u0[j];
    drift_ += gradient * shift;
    finish(gradient + curvature * shift, curvature);
  }

  /// Adds the slope of an input that only u0 moves: the force of a swing foot.
  void add_drift(const Batch& gradient, int i) noexcept { drift_ += gradient * projection_.u0[i]; }

  /// First-order change of the cost along u0.
  [[nodiscard]] const Batch& drift() const noexcept { return drift_; }

  /// Sums gradient and lower half of the Hessian over all rows. Blocks of 4 x 2 entries stay in registers.
  void accumulate(Batch (&gradient)[kColumns], Batch (&hessian)[kColumns][kColumns]) const noexcept {
    for (int c = 0; c < kColumns; ++c) {
      Batch sum = Batch(0.0);
      for (int r = 0; r < count_; ++r) sum += slope_[r] * rows_[r][c];
      gradient[c] = sum;
    }
    for (int i = 0; i < kColumns; i += 4) {
      for (int j = 0; j < i + 4; j += 2) {
        Batch sum[4][2] = {};
        for (int r = 0; r < count_; ++r) {
          const Batch b0 = weighted_[r][j];
          const Batch b1 = weighted_[r][j + 1];
          for (int k = 0; k < 4; ++k) {
            const Batch a = rows_[r][i + k];
            sum[k][0] += a * b0;
            sum[k][1] += a * b1;
          }
        }
        for (int k = 0; k < 4; ++k) {
          hessian[i + k][j] = sum[k][0];
          hessian[i + k][j + 1] = sum[k][1];
        }
      }
    }
  }

 private:
  void finish(const Batch& slope, const Batch& curvature) noexcept {
    slope_[count_] = slope;
    for (int c = 0; c < kColumns; ++c) weighted_[count_][c] = curvature * rows_[count_][c];
    ++count_;
  }

  const Projection<Mode>& projection_;
  int count_ = 0;
  Batch rows_[kMaxRows][kColumns];
  Batch weighted_[kMaxRows][kColumns];
  Batch slope_[kMaxRows];
  Batch drift_ = Batch(0.0);
};

/// Rows of joint accelerations, torques (limits), foot accelerations and stance forces (friction cone).
template <class Mode>
void add_dense_rows(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                    const model::NodeDerivatives<Batch>& node, DenseRows<Mode>& rows) noexcept {
  using model::kAngles;
  using model::kInputs;
  using model::kJoints;
  for (int j = 0; j < kJoints; ++j) {
    const Batch weight = Batch(data.input_weight[j]);
    rows.add_input(weight * (it.u[j] - batch.u_ref[j]), weight, j, Batch(1.0), j, Batch(0.0));
  }
  const auto dense = [&](const Batch& gradient, const Batch& curvature, const Batch(&by_theta)[kAngles],
                         const Batch(&by_omega)[kAngles], const Batch(&by_input)[kInputs]) {
    Batch dx[kReducedStates];
    for (Batch& entry : dx) entry = Batch(0.0);
    for (int c = 0; c < kAngles; ++c) {
      dx[kThetaColumn + c] = by_theta[c];
      dx[kOmegaColumn + c] = by_omega[c];
    }
    rows.add(gradient, curvature, dx, by_input);
  };
  for (int j = 0; j < kJoints; ++j) {
    const BarrierSlope above =
        barrier_slope(data.inequality.joint_torque, data.limits.torque_Nm[j] + node.joint_torque[j]);
    const BarrierSlope below =
        barrier_slope(data.inequality.joint_torque, data.limits.torque_Nm[j] - node.joint_torque[j]);
    dense(above.first - below.first, above.second + below.second, node.joint_torque_dtheta[j],
          node.joint_torque_domega[j], node.joint_torque_du[j]);
  }
  for (int i = 0; i < 2 * model::kFeet; ++i) {
    const Batch weight = Batch(data.cost.foot_acceleration);
    dense(weight * (node.foot_acceleration[i] - batch.foot_acceleration_ref[i]), weight,
          node.foot_acceleration_dtheta[i], node.foot_acceleration_domega[i], node.foot_acceleration_du[i]);
  }
  // Force of a stance foot: weight and both sides of the cone make a 2 x 2 Hessian H = L L'; its rows are
  // those of L', with slopes L^-1 g.
  const InequalityParameters& p = data.inequality;
  for (int foot = 0; foot < model::kFeet; ++foot) {
    const int x = kJoints + 2 * foot;
    const int z = x + 1;
    if (!Mode::stance(foot)) {
      for (const int i : {x, z}) rows.add_drift(data.input_weight[i] * (it.u[i] - batch.u_ref[i]), i);
      continue;
    }
    const double mu = p.friction_coefficient;
    const Batch margin = mu * (it.u[z] - p.minimum_normal_force_N);
    const BarrierSlope front = barrier_slope(p.friction, margin - it.u[x]);
    const BarrierSlope back = barrier_slope(p.friction, margin + it.u[x]);
    const Batch gx = data.input_weight[x] * (it.u[x] - batch.u_ref[x]) + back.first - front.first;
    const Batch gz = data.input_weight[z] * (it.u[z] - batch.u_ref[z]) + mu * (back.first + front.first);
    const Batch hxx = data.input_weight[x] + back.second + front.second;
    const Batch hxz = mu * (back.second - front.second);
    const Batch hzz = data.input_weight[z] + mu * mu * (back.second + front.second);
    const Batch l00 = sqrt(hxx);
    const Batch l10 = hxz / l00;
    const Batch l11 = sqrt(hzz - l10 * l10);
    const Batch s0 = gx / l00;
    rows.add_input(s0, Batch(1.0), x, l00, z, l10);
    rows.add_input((gz - l10 * s0) / l11, Batch(1.0), z, l11, z, Batch(0.0));
  }
}

/// Terms that need no projection: state weights, joint limits, foot positions and velocities. Adds gradient
/// and both halves of the Hessian over the full state.
void add_state_terms(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                     const model::NodeDerivatives<Batch>& node, Batch (&gradient)[model::kStates],
                     Batch (&hessian)[model::kStates][model::kStates]) noexcept;

}  // namespace stilt::ocp
