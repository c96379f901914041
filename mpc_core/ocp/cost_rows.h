#pragma once

#include <algorithm>

#include "mpc_core/ocp/projection.h"

/// The rows whose weighted outer products add up to the Hessian of a batch's cost, see quadratic_cost.h.
namespace stilt::ocp {

/// Rows of H are padded to whole blocks of four.
inline constexpr int kPaddedColumns = (kMaxReducedColumns + 3) / 4 * 4;

/// 1/2 d' H d + g' d over d = (dz_b, theta, v, omega, w), and the terms of x_b, which couples with theta
/// only.
struct QuadraticCost {
  Batch H[kPaddedColumns][kPaddedColumns];  ///< lower half
  Batch g[kPaddedColumns];
  Batch x_gradient;
  Batch x_curvature;
  Batch x_by_theta[model::kAngles];
  Batch constraint_step_slope;  ///< first-order change of the cost along the step onto the constraints
};

/// The rows of a batch, each with slope and curvature of its cost term.
template <class Mode>
class DenseRows {
 public:
  /// Weights of z: with one constraint a single row for c, otherwise one row per variable.
  static constexpr bool kUniform = Mode::kConstraints == 1;
  /// Joint torques, the unconstrained acceleration of each swing foot, two for the first stance force.
  static constexpr int kRows = model::kJoints + (model::kFeet - Mode::kStanceFeet) +
                               (Mode::kStanceFeet > 0 ? 2 : 0) + (kUniform ? 1 : Mode::kVariables);
  static constexpr int kColumns = (Mode::kReducedColumns + 3) / 4 * 4;

  DenseRows(const ForceElimination<Mode>& force, const ConstraintElimination<Mode>& constraint) noexcept
      : force_(force), constraint_(constraint) {}

  /// Adds the row of a quantity given by its derivatives.
  void add(const Batch& slope, const Batch& curvature, const Slopes& by) noexcept {
    const SubstitutedRow<Mode> row(force_, by);
    add_row(slope, curvature, row.step, row.by_z,
            [&](auto c) STILT_INLINE { return row.template by_state<c>(); });
  }

  /// Adds the combined force of the first stance foot, fx + by_z fz.
  void add_force(const Batch& slope, const Batch& curvature, const Batch& by_z) noexcept {
    const auto entry = [&](int c) STILT_INLINE { return force_.slope[0][c] + by_z * force_.slope[1][c]; };
    Batch by_variables[Mode::kVariables];
    for (int v = 0; v < Mode::kVariables; ++v) by_variables[v] = entry(kStateColumns + v);
    add_row(slope, curvature, force_.constant[0] + by_z * force_.constant[1], by_variables, entry);
  }

  /// Adds the vertical force of the first stance foot.
  void add_vertical_force(const Batch& slope, const Batch& curvature) noexcept {
    add_row(slope, curvature, force_.constant[1], force_.slope[1] + kStateColumns,
            [&](int c) STILT_INLINE { return force_.slope[1][c]; });
  }

  /// Adds a combination of the variables z.
  void add_variables(const Batch& slope, const Batch& curvature, const Batch* by_z) noexcept {
    add_row(slope, curvature, Batch(0.0), by_z, [](int) STILT_INLINE { return Batch(0.0); });
  }

  /// Adds c_0 itself; `slope` is the slope at dx = 0.
  void add_constraint(const Batch& slope, const Batch& curvature) noexcept {
    Batch* row = rows_[count_];
    row[kHeightColumn] = Batch(constraint_.by_height[0]);
    std::copy(constraint_.row[0], constraint_.row[0] + kStateColumns, row + kFirstStateColumn);
    for (int c = kFirstFree; c < kColumns; ++c) row[c] = Batch(0.0);
    for (int c = 0; c < kColumns; ++c) weighted_[count_][c] = curvature * row[c];
    slope_[count_++] = slope;
  }

  /// Sums gradient and lower half of the Hessian over all rows, in blocks of 4 x 2 that stay in registers. Of
  /// the second block on the diagonal only the lower half is computed.
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
    out.constraint_step_slope = constraint_step_slope_;
  }

 private:
  /// `step`: value of the quantity's step at dx = 0, z = 0.
  template <class ByState>
  STILT_INLINE void add_row(const Batch& slope, const Batch& curvature, const Batch& step, const Batch* by_z,
                            const ByState& by_state) noexcept {
    Batch* row = rows_[count_];
    Batch* weighted = weighted_[count_];
    const auto store = [&](auto column, const Batch& entry) STILT_INLINE {
      row[column] = entry;
      weighted[column] = curvature * entry;
    };
    const Batch reached = step + constraint_.substitute(by_z, by_state, store);
    for (int c = Mode::kReducedColumns; c < kColumns; ++c) row[c] = weighted[c] = Batch(0.0);
    constraint_step_slope_ += slope * reached;
    slope_[count_++] = slope + curvature * reached;
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
  Batch constraint_step_slope_ = Batch(0.0);
};

}  // namespace stilt::ocp
