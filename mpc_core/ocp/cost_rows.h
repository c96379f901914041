#pragma once

#include "mpc_core/ocp/projection.h"

/// The rows whose weighted outer products add up to the Hessian of a batch's cost, see quadratic_cost.h.
namespace stilt::ocp {

/// Rows of H are padded to whole blocks of four.
inline constexpr int kPaddedColumns = (kMaxReducedColumns + 3) / 4 * 4;

/// Index of the first joint among the angles; pitch comes first.
inline constexpr int kFirstJointAngle = model::kFirstJoint - model::kFirstAngle;

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

/// A cost term of slope g and curvature c over some quantity, as one of curvature 1 over the quantity times
/// `scale`. It has scale = sqrt(c), slope = g / sqrt(c). A term without curvature has no slope either.
struct UnitTerm {
  Batch scale;
  Batch slope;

  UnitTerm() = default;
  STILT_INLINE UnitTerm(const Batch& g, const Batch& c) noexcept : scale(sqrt(max(c, Batch(0.0)))) {
    constexpr double kNoDivisionByZero = 1e-150;
    slope = g / (scale + kNoDivisionByZero);
  }
};

/// The rows of a batch, each scaled so that its cost term has curvature 1. The Hessian is then the sum of the
/// outer products of the rows with themselves. Terms are computed before the first row is added: their roots
/// and divisions would delay it.
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
  void add(const UnitTerm& term, const Slopes& by) noexcept {
    const SubstitutedRow<Mode, Batch> row(force_, by, term.scale);
    add_row(term, row.step, row.by_z, [&](auto c) STILT_INLINE { return row.template by_state<c>(); });
  }

  /// Adds the row of a quantity given by its derivatives, and by `more` more by the rate of joint `joint`.
  void add(const UnitTerm& term, const Slopes& by, int joint, const Batch& more) noexcept {
    add(term, by);
    rows_[count_ - 1][kFirstStateColumn + kOmegaColumn + kFirstJointAngle + joint] += term.scale * more;
  }

  /// Adds the combined force of the first stance foot, fx + by_z fz.
  void add_force(const UnitTerm& term, const Batch& by_z) noexcept {
    const Batch scaled_by_z = term.scale * by_z;
    add_force_row(
        term, [&](const Batch& x, const Batch& z) STILT_INLINE { return term.scale * x + scaled_by_z * z; });
  }

  /// Adds the vertical force of the first stance foot.
  void add_vertical_force(const UnitTerm& term) noexcept {
    add_force_row(term, [&](const Batch&, const Batch& z) STILT_INLINE { return term.scale * z; });
  }

  /// Adds a combination of the variables z.
  void add_variables(const UnitTerm& term, const Batch* by_z) noexcept {
    Batch scaled_by_z[Mode::kVariables];
    for (int v = 0; v < Mode::kVariables; ++v) scaled_by_z[v] = term.scale * by_z[v];
    add_row(term, Batch(0.0), scaled_by_z, [](int) STILT_INLINE { return Batch(0.0); });
  }

  /// Adds c_0 itself; the slope of `term` is that at dx = 0.
  void add_constraint(const UnitTerm& term) noexcept {
    Batch* row = rows_[count_];
    row[kHeightColumn] = term.scale * constraint_.by_height[0];
    for (int c = 0; c < kStateColumns; ++c) row[kFirstStateColumn + c] = term.scale * constraint_.row[0][c];
    for (int c = kFirstFree; c < kColumns; ++c) row[c] = Batch(0.0);
    slope_[count_++] = term.slope;
  }

  /// Sums gradient and lower half of the Hessian over all rows. Works in blocks of 4 x 2, which stay in
  /// registers, and in the lower halves of blocks of 4 x 4 on the diagonal.
  void accumulate(QuadraticCost& out) const noexcept {
    for (int c = 0; c < kColumns; ++c) {
      Batch sum = slope_[0] * rows_[0][c];
      for (int r = 1; r < kRows; ++r) sum += slope_[r] * rows_[r][c];
      out.g[c] = sum;
    }
    for (int i = 0; i < kColumns; i += 4) {
      for (int j = 0; j < i; j += 2) block(i, j, out);
      diagonal_block(i, out);
    }
    out.constraint_step_slope = constraint_step_slope_;
  }

 private:
  /// `entry(x, z)`: the scaled quantity from fx and fz.
  template <class Entry>
  STILT_INLINE void add_force_row(const UnitTerm& term, const Entry& entry) noexcept {
    const auto at = [&](int c) STILT_INLINE { return entry(force_.slope[0][c], force_.slope[1][c]); };
    Batch by_z[Mode::kVariables];
    for (int v = 0; v < Mode::kVariables; ++v) by_z[v] = at(kStateColumns + v);
    add_row(term, entry(force_.constant[0], force_.constant[1]), by_z, at);
  }

  /// Arguments but `term` are of the scaled quantity; `step`: value of its step at dx = 0, z = 0.
  template <class ByState>
  STILT_INLINE void add_row(const UnitTerm& term, const Batch& step, const Batch* by_z,
                            const ByState& by_state) noexcept {
    Batch* row = rows_[count_];
    const ReducedRow<Mode, ByState> reduced(constraint_, by_z, by_state);
    lq::unroll<Mode::kReducedColumns>([&](auto c) STILT_INLINE { row[c] = reduced.template entry<c>(); });
    const Batch reached = step + reduced.step_through_z();
    for (int c = Mode::kReducedColumns; c < kColumns; ++c) row[c] = Batch(0.0);
    constraint_step_slope_ += term.slope * reached;
    slope_[count_++] = term.slope + reached;
  }

  /// Entries (i ... i + 3) x (j, j + 1) of the Hessian.
  STILT_INLINE void block(int i, int j, QuadraticCost& out) const noexcept {
    Batch sum[4][2] = {};
    for (const Batch(&row)[kColumns] : rows_) {
      const Batch b0 = row[j];
      const Batch b1 = row[j + 1];
      for (int k = 0; k < 4; ++k) {
        const Batch a = row[i + k];
        sum[k][0] += a * b0;
        sum[k][1] += a * b1;
      }
    }
    for (int k = 0; k < 4; ++k) {
      out.H[i + k][j] = sum[k][0];
      out.H[i + k][j + 1] = sum[k][1];
    }
  }

  /// Lower half of the entries (i ... i + 3) x (i ... i + 3) of the Hessian.
  STILT_INLINE void diagonal_block(int i, QuadraticCost& out) const noexcept {
    const auto for_lower_half = [](const auto& body) STILT_INLINE {
      lq::unroll<4>([&](auto k)
                        STILT_INLINE { lq::unroll<k + 1>([&](auto l) STILT_INLINE { body(k, l); }); });
    };
    Batch sum[4][4] = {};
    for (const Batch(&row)[kColumns] : rows_) {
      for_lower_half([&](int k, int l) STILT_INLINE { sum[k][l] += row[i + k] * row[i + l]; });
    }
    for_lower_half([&](int k, int l) STILT_INLINE { out.H[i + k][i + l] = sum[k][l]; });
  }

  const ForceElimination<Mode>& force_;
  const ConstraintElimination<Mode>& constraint_;
  int count_ = 0;
  Batch rows_[kRows][kColumns];
  Batch slope_[kRows];
  Batch constraint_step_slope_ = Batch(0.0);
};

}  // namespace stilt::ocp
