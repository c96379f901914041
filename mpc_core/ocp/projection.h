#pragma once

#include "mpc_core/model/batch.h"
#include "mpc_core/model/terms.h"
#include "mpc_core/ocp/problem.h"

/// Equality constraints of a node and their elimination, in closed form for each contact mode.
///
/// Rows, all affine in the input:
///   stance foot:  a + kd v = 0                                            (x and z)
///   swing foot:   a_z - a_ref + kd (v_z - v_ref) + kp (p_z - p_ref) = 0,  f = 0
/// Elimination, du = u0 + X dx + W w:
///   1. swing forces go to zero;
///   2. the force of the first stance foot follows from its two rows: their 2 x 2 block J_b M_bb^-1 J_b' is
///      symmetric positive definite in every posture;
///   3. the remaining rows (the swing foot's height, or the other stance foot) are triangularised by
///   Householder
///      reflections over the joint accelerations (and the other stance force); the reflected unit vectors
///      span their null space: 3 free directions in single support, 4 in double support, 2 in flight.
/// Rank: step 3 is singular where the row vanishes, as for two straight legs side by side. A diagonal entry s
/// below `rank_tolerance` is inverted as s / tolerance^2, so that the constraint fades instead of exploding.
namespace stilt::ocp {

/// Columns of the state that the constraints and the dense cost rows depend on: all but x_b.
inline constexpr int kReducedStates = model::kStates - 1;

/// Compile-time facts of a contact mode.
template <bool Left, bool Right>
struct ModeTraits {
  static constexpr bool kLeft = Left;
  static constexpr bool kRight = Right;
  static constexpr int kStanceFeet = int{Left} + int{Right};
  static constexpr int kFirstStance = Left ? 0 : 1;       ///< foot eliminated in step 2
  static constexpr int kRows = kStanceFeet == 1 ? 1 : 2;  ///< rows left for step 3
  /// Variables of step 3: joint accelerations, and in double support the right foot's force.
  static constexpr int kVariables = model::kJoints + (kStanceFeet == 2 ? 2 : 0);
  static constexpr int kFree = kVariables - kRows;
  [[nodiscard]] static constexpr bool stance(int foot) noexcept { return foot == 0 ? Left : Right; }
};

/// du = u0 + X dx + W w for the inputs that are not swing forces (whose step is u0 alone).
template <class Mode>
struct Projection {
  Batch u0[model::kInputs];
  Batch X[model::kInputs][kReducedStates];
  Batch W[model::kInputs][Mode::kFree];
};

/// One constraint row: residual, derivative by the state (without x_b) and by the input.
struct ConstraintRow {
  Batch residual;
  Batch dx[kReducedStates];
  Batch du[model::kInputs];
};

/// Index of theta[i], of its rate, and of the base velocity r in the reduced state.
inline constexpr int kThetaColumn = model::kFirstAngle - 1;
inline constexpr int kOmegaColumn = model::kPositions + model::kFirstAngle - 1;
inline constexpr int kVelocityColumn = model::kPositions - 1;

/// Residual of the row of foot `foot`, direction `axis` (0: x, 1: z).
inline Batch constraint_residual(const EqualityParameters& p, const StageBatch& batch, bool stance, int foot,
                                 int axis, const Batch* position, const Batch* velocity,
                                 const Batch* acceleration) noexcept {
  const int i = 2 * foot + axis;
  if (stance) return acceleration[i] + p.stance_kd_1_s * velocity[i];
  return acceleration[i] - batch.foot_acceleration_ref[i] +
         p.swing_kd_1_s * (velocity[i] - batch.foot_velocity_ref[i]) +
         p.swing_kp_1_s2 * (position[i] - batch.foot_position_ref[i]);
}

inline void constraint_row(const EqualityParameters& p, const StageBatch& batch, bool stance, int foot,
                           int axis, const model::NodeDerivatives<Batch>& node, ConstraintRow& row) noexcept {
  const int i = 2 * foot + axis;
  const double kd = stance ? p.stance_kd_1_s : p.swing_kd_1_s;
  const double kp = stance ? 0.0 : p.swing_kp_1_s2;
  row.residual = constraint_residual(p, batch, stance, foot, axis, node.foot_position, node.foot_velocity,
                                     node.foot_acceleration);
  for (Batch& entry : row.dx) entry = Batch(0.0);
  if (axis == 1) row.dx[0] = Batch(kp);
  row.dx[kVelocityColumn + axis] = Batch(kd);
  for (int c = 0; c < model::kAngles; ++c) {
    row.dx[kThetaColumn + c] = node.foot_acceleration_dtheta[i][c];
    row.dx[kOmegaColumn + c] = node.foot_acceleration_domega[i][c];
  }
  for (int c = 0; c < model::kChain; ++c) {
    const int angle = model::kChainAngles[foot][c];
    row.dx[kThetaColumn + angle] +=
        kd * node.foot_velocity_dchain[i][c] + kp * node.foot_position_dchain[i][c];
    row.dx[kOmegaColumn + angle] += kd * node.foot_position_dchain[i][c];
  }
  for (int c = 0; c < model::kInputs; ++c) row.du[c] = node.foot_acceleration_du[i][c];
}

namespace detail {

/// 1/s, fading to s/tolerance^2 below the tolerance.
inline Batch damped_inverse(const Batch& s, double tolerance) noexcept {
  Batch inverse = s * (1.0 / (tolerance * tolerance));
  const auto regular = abs(s) > tolerance;
  where(regular, inverse) = 1.0 / s;
  return inverse;
}

/// Solves the R rows M z = rhs over N variables: reflections H_1..H_R with M H_1..H_R lower triangular.
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

/// Eliminates the equality constraints of a batch in contact mode `Mode`. `u`: inputs of the iterate.
template <class Mode>
void project(const EqualityParameters& parameters, const StageBatch& batch, const Batch* u,
             const model::NodeDerivatives<Batch>& node, Projection<Mode>& out) noexcept {
  constexpr int kJoints = model::kJoints;
  constexpr int kVariables = Mode::kVariables;
  constexpr int kRows = Mode::kRows;
  constexpr bool kAnyStance = Mode::kStanceFeet > 0;
  constexpr int kFirst = Mode::kFirstStance;
  constexpr int kFirstForce = kJoints + 2 * kFirst;

  // Step 1. Swing forces go to zero; their step moves the residuals of the other rows.
  for (int foot = 0; foot < model::kFeet; ++foot) {
    for (int axis = 0; axis < 2; ++axis) {
      if (!Mode::stance(foot)) out.u0[kJoints + 2 * foot + axis] = -u[kJoints + 2 * foot + axis];
    }
  }
  const auto load = [&](int foot, int axis, ConstraintRow& row) {
    constraint_row(parameters, batch, Mode::stance(foot), foot, axis, node, row);
    for (int other = 0; other < model::kFeet; ++other) {
      if (Mode::stance(other)) continue;
      for (int i = kJoints + 2 * other; i < kJoints + 2 * other + 2; ++i)
        row.residual += row.du[i] * out.u0[i];
    }
  };
  // Index into u of variable c of step 3.
  const auto variable = [](int c) { return c < kJoints ? c : kJoints + 2 + (c - kJoints); };

  // Step 2. f = -(f0 + fx dx + fz z), z the variables of step 3.
  Batch f0[2];
  Batch fx[2][kReducedStates];
  Batch fz[2][kVariables];
  if constexpr (kAnyStance) {
    ConstraintRow row[2];
    load(kFirst, 0, row[0]);
    load(kFirst, 1, row[1]);
    const Batch a = row[0].du[kFirstForce];
    const Batch b = row[0].du[kFirstForce + 1];
    const Batch c = row[1].du[kFirstForce];
    const Batch d = row[1].du[kFirstForce + 1];
    const Batch scale = 1.0 / (a * d - b * c);
    const auto solve = [&](const Batch& r0, const Batch& r1, Batch& s0, Batch& s1) {
      s0 = (d * r0 - b * r1) * scale;
      s1 = (a * r1 - c * r0) * scale;
    };
    solve(row[0].residual, row[1].residual, f0[0], f0[1]);
    for (int i = 0; i < kReducedStates; ++i) solve(row[0].dx[i], row[1].dx[i], fx[0][i], fx[1][i]);
    for (int i = 0; i < kVariables; ++i) {
      solve(row[0].du[variable(i)], row[1].du[variable(i)], fz[0][i], fz[1][i]);
    }
  }

  // Step 3. Remaining rows over z, with the first stance force substituted.
  ConstraintRow row[kRows];
  Batch m[kRows][kVariables];
  if constexpr (Mode::kStanceFeet == 1) {
    load(1 - kFirst, 1, row[0]);
  } else if constexpr (Mode::kStanceFeet == 2) {
    load(1, 0, row[0]);
    load(1, 1, row[1]);
  } else {
    load(0, 1, row[0]);
    load(1, 1, row[1]);
  }
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kVariables; ++c) m[r][c] = row[r].du[variable(c)];
    if constexpr (kAnyStance) {
      for (int k = 0; k < 2; ++k) {
        const Batch by_force = row[r].du[kFirstForce + k];
        row[r].residual -= by_force * f0[k];
        for (int i = 0; i < kReducedStates; ++i) row[r].dx[i] -= by_force * fx[k][i];
        for (int c = 0; c < kVariables; ++c) m[r][c] -= by_force * fz[k][c];
      }
    }
  }
  const detail::RowTriangularisation<kRows, kVariables> triangular(m, parameters.rank_tolerance);

  Batch range[kRows][kVariables];
  for (int r = 0; r < kRows; ++r) triangular.axis(r, range[r]);
  const auto particular = [&](auto&& entry, auto&& store) {
    Batch y[kRows];
    for (int r = 0; r < kRows; ++r) y[r] = -entry(r);
    triangular.solve(y);
    for (int c = 0; c < kVariables; ++c) {
      Batch z = y[0] * range[0][c];
      for (int r = 1; r < kRows; ++r) z += y[r] * range[r][c];
      store(c, z);
    }
  };
  particular([&](int r) { return row[r].residual; }, [&](int c, const Batch& z) { out.u0[variable(c)] = z; });
  for (int i = 0; i < kReducedStates; ++i) {
    particular([&](int r) { return row[r].dx[i]; },
               [&](int c, const Batch& z) { out.X[variable(c)][i] = z; });
  }
  for (int k = 0; k < Mode::kFree; ++k) {
    Batch z[kVariables];
    triangular.axis(kRows + k, z);
    for (int c = 0; c < kVariables; ++c) out.W[variable(c)][k] = z[c];
  }

  // Back to the first stance force.
  if constexpr (kAnyStance) {
    for (int k = 0; k < 2; ++k) {
      const int force = kFirstForce + k;
      out.u0[force] = -f0[k];
      for (int i = 0; i < kReducedStates; ++i) out.X[force][i] = -fx[k][i];
      for (int j = 0; j < Mode::kFree; ++j) out.W[force][j] = Batch(0.0);
      for (int c = 0; c < kVariables; ++c) {
        out.u0[force] -= fz[k][c] * out.u0[variable(c)];
        for (int i = 0; i < kReducedStates; ++i) out.X[force][i] -= fz[k][c] * out.X[variable(c)][i];
        for (int j = 0; j < Mode::kFree; ++j) out.W[force][j] -= fz[k][c] * out.W[variable(c)][j];
      }
    }
  }
}

}  // namespace stilt::ocp
