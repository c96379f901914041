#pragma once

#include "mpc_core/lq/simd_columns.h"
#include "mpc_core/model/batch.h"
#include "mpc_core/model/terms.h"
#include "mpc_core/ocp/problem.h"

// clang-format off
/// Equality constraints of a node and their elimination, in closed form for each contact mode.
///
/// Rows, all affine in the input:
///   stance foot:  a + kd v = 0                                            (x and z)
///   swing foot:   a_z - a_ref + kd (v_z - v_ref) + kp (p_z - p_ref) = 0,  f = 0
/// Elimination:
///   1. swing forces go to zero;
///   2. the force of the first stance foot follows from its two rows. Their 2 x 2 block J_b M_bb^-1 J_b' is
///      symmetric positive definite in every posture. The variables z remain: the joint accelerations, and in
///      double support the force of the other foot;
///   3. the remaining rows c'dx + m'z + rho = 0 are the swing foot's height, or the other stance foot. They
///      give z = z0 + Y c'dx + W w by Householder reflections over z. The reflected unit vectors W span their
///      null space: 3 free directions in single support, 4 in double support, 2 in flight.
/// dx affects z only through the one or two products c'dx. Together with the base rows they are the factored
/// dynamics of lq/lq_problem.h. lq::forward_sweep and Sqp::feedback_gain undo the elimination. Why:
/// docs/decisions/0003-projected-multiple-shooting.md.
///
/// Rank: step 3 is singular where the row vanishes, as for two straight legs side by side. A diagonal entry s
/// below `rank_tolerance` is inverted as s / tolerance^2: the constraint fades, and the inverse stays
/// bounded.
// clang-format on
namespace stilt::ocp {

/// Columns of the state on which all terms depend but the height constraint and the costs of x_b and z_b:
/// theta (5), base velocity (2), omega (5). Column c is state kFirstAngle + c.
inline constexpr int kStateColumns = model::kStates - model::kFirstAngle;
inline constexpr int kThetaColumn = 0;
inline constexpr int kVelocityColumn = model::kPositions - model::kFirstAngle;
inline constexpr int kOmegaColumn = model::kPositions;

/// Columns of a row over (dz_b, dx, w) after substitution of z: the height of the base, the columns above,
/// the free directions.
inline constexpr int kHeightColumn = 0;
inline constexpr int kFirstStateColumn = 1;
inline constexpr int kFirstFree = kFirstStateColumn + kStateColumns;

/// Compile-time facts of a contact mode.
template <bool Left, bool Right>
struct ModeTraits {
  static constexpr int kStanceFeet = int{Left} + int{Right};
  static constexpr int kFirstStance = Left ? 0 : 1;  ///< foot eliminated in step 2
  static constexpr int kFirstForce = model::kJoints + 2 * kFirstStance;
  static constexpr int kConstraints = kStanceFeet == 1 ? 1 : 2;  ///< rows left for step 3
  /// Variables z of step 3: joint accelerations, and in double support the right foot's force.
  static constexpr int kVariables = model::kJoints + (kStanceFeet == 2 ? 2 : 0);
  static constexpr int kFree = kVariables - kConstraints;
  static constexpr int kColumns = kStateColumns + kVariables;  ///< of a row over (dx, z)
  static constexpr int kReducedColumns = kFirstFree + kFree;   ///< of a row over (dz_b, dx, w)
  [[nodiscard]] static constexpr bool stance(int foot) noexcept { return foot == 0 ? Left : Right; }
  /// Foot and axis of row r of step 3.
  [[nodiscard]] static constexpr int row_foot(int r) noexcept {
    return kStanceFeet == 1 ? 1 - kFirstStance : kStanceFeet == 2 ? 1 : r;
  }
  [[nodiscard]] static constexpr int row_axis(int r) noexcept { return kStanceFeet == 2 ? r : 1; }
  /// Index into u of variable v.
  [[nodiscard]] static constexpr int input(int v) noexcept { return v < model::kJoints ? v : v + 2; }
};

/// Largest size over all modes.
inline constexpr int kMaxReducedColumns = kFirstFree + lq::kMaxFreeInputs;

/// Scalar product over the variables z.
template <class Mode>
[[nodiscard]] STILT_INLINE inline Batch over_variables(const Batch* a, const Batch* b) noexcept {
  Batch sum = a[0] * b[0];
  for (int v = 1; v < Mode::kVariables; ++v) sum += a[v] * b[v];
  return sum;
}

/// Derivatives of one quantity: by theta (5), omega (5) and u (8).
struct Slopes {
  const Batch* theta;
  const Batch* omega;
  const Batch* input;
};

/// One constraint row: residual and derivatives; the derivatives by base velocity and height are constants.
struct ConstraintRow {
  Batch residual;
  Batch theta[model::kAngles];
  Batch omega[model::kAngles];
  const Batch* input = nullptr;
  double by_velocity = 0.0;  ///< derivative by the base velocity along the row's axis
  double by_height = 0.0;

  [[nodiscard]] Slopes slopes() const noexcept { return {theta, omega, input}; }
};

/// Residual of the row of foot `foot` along `axis` (0: x, 1: z).
inline Batch constraint_residual(const EqualityParameters& p, const StageBatch& batch, bool stance, int foot,
                                 int axis, const Batch* position, const Batch* velocity,
                                 const Batch* acceleration) noexcept {
  const int i = 2 * foot + axis;
  if (stance) return acceleration[i] + p.stance_kd_1_s * velocity[i];
  return acceleration[i] - batch.foot_acceleration_ref[i] +
         p.swing_kd_1_s * (velocity[i] - batch.foot_velocity_ref[i]) +
         p.swing_kp_1_s2 * (position[i] - batch.foot_position_ref[i]);
}

/// Computes the constraint row of foot `foot` along `axis` (0: x, 1: z): residual and derivatives.
inline void constraint_row(const EqualityParameters& p, const StageBatch& batch, bool stance, int foot,
                           int axis, const model::NodeDerivatives<Batch>& node, ConstraintRow& row) noexcept {
  const int i = 2 * foot + axis;
  const double kd = stance ? p.stance_kd_1_s : p.swing_kd_1_s;
  const double kp = stance ? 0.0 : p.swing_kp_1_s2;
  row.residual = constraint_residual(p, batch, stance, foot, axis, node.foot_position, node.foot_velocity,
                                     node.foot_acceleration);
  row.by_velocity = kd;
  row.by_height = kp;
  for (int c = 0; c < model::kAngles; ++c) {
    row.theta[c] = node.foot_acceleration_dtheta[i][c];
    row.omega[c] = node.foot_acceleration_domega[i][c];
  }
  for (int c = 0; c < model::kChain; ++c) {
    const int angle = model::kChainAngles[foot][c];
    row.theta[angle] += kd * node.foot_velocity_dchain[i][c] + kp * node.foot_position_dchain[i][c];
    row.omega[angle] += kd * node.foot_position_dchain[i][c];
  }
  row.input = node.foot_acceleration_du[i];
}

namespace detail {

/// 1/s; below the tolerance s/tolerance^2, which fades to zero.
inline Batch damped_inverse(const Batch& s, double tolerance) noexcept {
  Batch inverse = s * (1.0 / (tolerance * tolerance));
  const auto regular = abs(s) > tolerance;
  where(regular, inverse) = 1.0 / s;
  return inverse;
}

/// Solves the R rows M z = rhs over N variables, with reflections H_1..H_R that make M H_1..H_R lower
/// triangular.
template <int R, int N>
class RowTriangularisation {
 public:
  explicit RowTriangularisation(const Batch (&m)[R][N], double tolerance) noexcept {
    Batch row[R][N];
    for (int r = 0; r < R; ++r) {
      for (int c = 0; c < N; ++c) row[r][c] = m[r][c];
    }
    for (int r = 0; r < R; ++r) {
      Batch norm_squared = Batch(0.0);
      for (int c = r; c < N; ++c) norm_squared += row[r][c] * row[r][c];
      const Batch signed_norm = copysign(sqrt(norm_squared), row[r][r]);
      for (int c = 0; c < N; ++c) v_[r][c] = c < r ? Batch(0.0) : row[r][c];
      v_[r][r] += signed_norm;
      const Batch half = norm_squared + signed_norm * row[r][r];  // v'v / 2
      beta_[r] = Batch(0.0);
      const auto nonzero = half > 1e-200;
      where(nonzero, beta_[r]) = 1.0 / half;
      for (int other = r; other < R; ++other) reflect(r, row[other]);
      inverse_diagonal_[r] = damped_inverse(row[r][r], tolerance);
      for (int c = 0; c < r; ++c) lower_[r][c] = row[r][c];
    }
  }

  /// Coordinates of the particular solution along the first R reflected axes.
  void solve(Batch (&rhs)[R]) const noexcept {
    for (int r = 0; r < R; ++r) {
      for (int c = 0; c < r; ++c) rhs[r] -= lower_[r][c] * rhs[c];
      rhs[r] *= inverse_diagonal_[r];
    }
  }

  /// Reflected unit vector number `axis`: H_1..H_R e_axis.
  void axis(int index, Batch (&z)[N]) const noexcept {
    for (int c = 0; c < N; ++c) z[c] = Batch(c == index ? 1.0 : 0.0);
    for (int r = R - 1; r >= 0; --r) reflect(r, z);
  }

 private:
  void reflect(int r, Batch (&z)[N]) const noexcept {
    Batch dot = Batch(0.0);
    for (int c = r; c < N; ++c) dot += v_[r][c] * z[c];
    dot *= beta_[r];
    for (int c = r; c < N; ++c) z[c] -= dot * v_[r][c];
  }

  Batch v_[R][N];
  Batch beta_[R];
  Batch lower_[R][R];
  Batch inverse_diagonal_[R];
};

}  // namespace detail

/// Steps 1 and 2: computes the forces as affine functions of (dx, z).
template <class Mode>
struct ForceElimination {
  Batch swing_step[2 * model::kFeet];  ///< step of the forces of feet in the air
  Batch constant[2];                   ///< first stance foot: f = constant + slope (dx, z)
  Batch slope[2][Mode::kColumns];

  void eliminate(const EqualityParameters& parameters, const StageBatch& batch, const Batch* u,
                 const model::NodeDerivatives<Batch>& node) noexcept {
    for (int i = 0; i < 2 * model::kFeet; ++i) {
      if (!Mode::stance(i / 2)) swing_step[i] = -u[model::kJoints + i];
    }
    if constexpr (Mode::kStanceFeet > 0) {
      ConstraintRow x, z;
      constraint_row(parameters, batch, true, Mode::kFirstStance, 0, node, x);
      constraint_row(parameters, batch, true, Mode::kFirstStance, 1, node, z);
      const Batch* by_force[2] = {x.input + Mode::kFirstForce, z.input + Mode::kFirstForce};
      // -[a b; c d]^-1, applied to both rows.
      const Batch scale = 1.0 / (by_force[0][1] * by_force[1][0] - by_force[0][0] * by_force[1][1]);
      const Batch a = by_force[0][0] * scale;
      const Batch b = by_force[0][1] * scale;
      const Batch c = by_force[1][0] * scale;
      const Batch d = by_force[1][1] * scale;
      const auto solve = [&](const Batch& row_x, const Batch& row_z, Batch& fx, Batch& fz) {
        fx = d * row_x - b * row_z;
        fz = a * row_z - c * row_x;
      };
      solve(x.residual + swing_share(x.input), z.residual + swing_share(z.input), constant[0], constant[1]);
      for (int i = 0; i < model::kAngles; ++i) {
        solve(x.theta[i], z.theta[i], slope[0][kThetaColumn + i], slope[1][kThetaColumn + i]);
        solve(x.omega[i], z.omega[i], slope[0][kOmegaColumn + i], slope[1][kOmegaColumn + i]);
      }
      slope[0][kVelocityColumn] = x.by_velocity * d;
      slope[1][kVelocityColumn] = -x.by_velocity * c;
      slope[0][kVelocityColumn + 1] = -z.by_velocity * b;
      slope[1][kVelocityColumn + 1] = z.by_velocity * a;
      for (int v = 0; v < Mode::kVariables; ++v) {
        solve(x.input[Mode::input(v)], z.input[Mode::input(v)], slope[0][kStateColumns + v],
              slope[1][kStateColumns + v]);
      }
    }
  }

  /// Step of a quantity by the swing forces alone.
  [[nodiscard]] Batch swing_share(const Batch* by_input) const noexcept {
    Batch sum = Batch(0.0);
    for (int i = 0; i < 2 * model::kFeet; ++i) {
      if (!Mode::stance(i / 2)) sum += by_input[model::kJoints + i] * swing_step[i];
    }
    return sum;
  }
};

/// Factor of a row that is not scaled.
struct One {};
[[nodiscard]] STILT_INLINE inline const Batch& operator*(One, const Batch& entry) noexcept { return entry; }

/// Row of a quantity over (dx, z) with the forces substituted, from its derivatives; a `scale` multiplies the
/// whole row. Its entries are computed in registers where they are used.
template <class Mode, class Scale = One>
struct SubstitutedRow {
  const ForceElimination<Mode>& force;
  const Slopes& from;
  const Scale scale;
  Batch by_force[2];
  Batch by_z[Mode::kVariables];
  Batch step;  ///< at dx = 0, z = 0

  STILT_INLINE SubstitutedRow(const ForceElimination<Mode>& elimination, const Slopes& slopes,
                              const Scale& by = {}) noexcept
      : force(elimination), from(slopes), scale(by) {
    step = scale * force.swing_share(from.input);
    if constexpr (Mode::kStanceFeet > 0) {
      for (int axis = 0; axis < 2; ++axis) by_force[axis] = scale * from.input[Mode::kFirstForce + axis];
      step += by_force[0] * force.constant[0] + by_force[1] * force.constant[1];
    }
    lq::unroll<Mode::kVariables>([&](auto v) STILT_INLINE {
      by_z[v] = scale * from.input[Mode::input(v)];
      add_force_share<kStateColumns + v>(by_z[v]);
    });
  }

  /// Derivative by column c of dx with z constant.
  template <int c>
  [[nodiscard]] STILT_INLINE Batch by_state() const noexcept {
    Batch sum;
    if constexpr (c < kVelocityColumn) {
      sum = scale * from.theta[c - kThetaColumn];
    } else if constexpr (c >= kOmegaColumn) {
      sum = scale * from.omega[c - kOmegaColumn];
    } else {
      sum = Batch(0.0);
    }
    add_force_share<c>(sum);
    return sum;
  }

 private:
  template <int c>
  STILT_INLINE void add_force_share(Batch& sum) const noexcept {
    if constexpr (Mode::kStanceFeet > 0) {
      sum += by_force[0] * force.slope[0][c] + by_force[1] * force.slope[1][c];
    }
  }
};

/// Step 3: z = z0 + sum_r Y_r c_r + sum_k W_k w_k with c_r = row_r dx + by_height_r dz_b. The W_k are
/// orthonormal and orthogonal to z0 and all Y_r.
template <class Mode>
struct ConstraintElimination {
  Batch row[Mode::kConstraints][kStateColumns];
  double by_height[Mode::kConstraints];
  Batch z0[Mode::kVariables];
  Batch Y[Mode::kConstraints][Mode::kVariables];
  Batch W[Mode::kFree][Mode::kVariables];

  void eliminate(const EqualityParameters& parameters, const StageBatch& batch,
                 const model::NodeDerivatives<Batch>& node, const ForceElimination<Mode>& force) noexcept {
    constexpr int kRows = Mode::kConstraints;
    Batch residual[kRows];
    Batch m[kRows][Mode::kVariables];
    for (int r = 0; r < kRows; ++r) {
      ConstraintRow full;
      const int foot = Mode::row_foot(r);
      const int axis = Mode::row_axis(r);
      constraint_row(parameters, batch, Mode::stance(foot), foot, axis, node, full);
      const Slopes slopes = full.slopes();
      const SubstitutedRow<Mode> substituted(force, slopes);
      residual[r] = full.residual + substituted.step;
      lq::unroll<kStateColumns>([&](auto c) STILT_INLINE { row[r][c] = substituted.template by_state<c>(); });
      row[r][kVelocityColumn + axis] += full.by_velocity;
      by_height[r] = full.by_height;
      for (int v = 0; v < Mode::kVariables; ++v) m[r][v] = substituted.by_z[v];
    }
    const detail::RowTriangularisation<kRows, Mode::kVariables> triangular(m, parameters.rank_tolerance);
    Batch range[kRows][Mode::kVariables];
    for (int r = 0; r < kRows; ++r) triangular.axis(r, range[r]);
    for (int r = 0; r < kRows; ++r) {
      Batch y[kRows];
      for (int s = 0; s < kRows; ++s) y[s] = Batch(s == r ? -1.0 : 0.0);
      triangular.solve(y);
      for (int v = 0; v < Mode::kVariables; ++v) {
        Y[r][v] = y[0] * range[0][v];
        for (int s = 1; s < kRows; ++s) Y[r][v] += y[s] * range[s][v];
        z0[v] = r == 0 ? Y[r][v] * residual[r] : z0[v] + Y[r][v] * residual[r];
      }
    }
    for (int k = 0; k < Mode::kFree; ++k) triangular.axis(kRows + k, W[k]);
  }
};

/// Row over (dz_b, dx, w) of a quantity, from its derivatives `by_z` and, with z constant, by_state(c) by
/// column c of dx. Its entries are computed in registers where they are used.
template <class Mode, class ByState>
class ReducedRow {
 public:
  STILT_INLINE ReducedRow(const ConstraintElimination<Mode>& constraint, const Batch* by_z,
                          const ByState& by_state) noexcept
      : constraint_(constraint), by_z_(by_z), by_state_(by_state) {
    for (int r = 0; r < Mode::kConstraints; ++r) {
      through_[r] = over_variables<Mode>(by_z, constraint.Y[r]);
    }
  }

  template <int column>
  [[nodiscard]] STILT_INLINE Batch entry() const noexcept {
    if constexpr (column >= kFirstFree) {
      return over_variables<Mode>(by_z_, constraint_.W[column - kFirstFree]);
    } else {
      constexpr int kState = column - kFirstStateColumn;
      Batch sum = Batch(0.0);
      if constexpr (column != kHeightColumn) sum = by_state_(std::integral_constant<int, kState>{});
      for (int r = 0; r < Mode::kConstraints; ++r) {
        if constexpr (column == kHeightColumn) {
          sum += through_[r] * constraint_.by_height[r];
        } else {
          sum += through_[r] * constraint_.row[r][kState];
        }
      }
      return sum;
    }
  }

  /// The quantity's step through z at dx = 0, w = 0.
  [[nodiscard]] STILT_INLINE Batch step_through_z() const noexcept {
    return over_variables<Mode>(by_z_, constraint_.z0);
  }

 private:
  const ConstraintElimination<Mode>& constraint_;
  const Batch* by_z_;
  const ByState& by_state_;
  Batch through_[Mode::kConstraints];
};

}  // namespace stilt::ocp
