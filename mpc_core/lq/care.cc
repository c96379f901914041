#include "mpc_core/lq/care.h"

#include <cmath>

#include "mpc_core/lq/small_solve.h"
#include "mpc_core/model/debug_assert.h"

namespace stilt::lq {
namespace {

constexpr int kN = model::kStates;
constexpr int kMostDoublings = 50;   ///< resolves a closed-loop pole 1e-13 times the shift
constexpr double kVanished = 1e-12;  ///< norm of the Cayley power at which doubling ends
constexpr int kRefinements = 3;
constexpr double kGoodResidual = 1e-14;   ///< below it no refinement
constexpr double kSmallestPivot = 1e-12;  ///< of an input weight scaled to a unit diagonal
/// Shifts tried in turn, relative to the square root of the Hamiltonian's norm.
constexpr double kShiftFactors[] = {1.0, 8.0, 1.0 / 8.0, 64.0, 1.0 / 64.0};

/// out = a b. `out` is neither a nor b.
template <class Out, class Left, class Right>
void multiply(Out& out, const Left& a, const Right& b) noexcept {
  out.noalias() = a.lazyProduct(b);
}

void symmetrise(StateMatrix& m) noexcept {
  for (int c = 0; c < kN; ++c) {
    for (int r = 0; r < c; ++r) m(r, c) = m(c, r) = 0.5 * (m(r, c) + m(c, r));
  }
}

/// Whether R is positive definite: Cholesky elimination with diagonal pivoting of R scaled to a unit
/// diagonal. A singular R leaves pivots that are zero up to rounding, of either sign.
[[nodiscard]] bool positive_definite(InputWeight R) noexcept {
  const auto diagonal = R.diagonal().eval();
  if (!(diagonal.minCoeff() > 0.0)) return false;
  for (int c = 0; c < model::kInputs; ++c) {
    for (int r = 0; r < model::kInputs; ++r) R(r, c) /= std::sqrt(diagonal[r] * diagonal[c]);
  }
  for (int k = 0; k < model::kInputs; ++k) {
    int largest = k;
    for (int i = k + 1; i < model::kInputs; ++i) {
      if (R(i, i) > R(largest, largest)) largest = i;
    }
    R.row(k).swap(R.row(largest));
    R.col(k).swap(R.col(largest));
    if (!(R(k, k) > kSmallestPivot)) return false;
    for (int r = k + 1; r < model::kInputs; ++r) {
      const double factor = R(r, k) / R(k, k);
      R.row(r) -= factor * R.row(k);
    }
  }
  return true;
}

/// Writes the inverse of `m` to the left half of work.right. False when `m` is singular.
[[nodiscard]] bool invert(const StateMatrix& m, CareWorkspace& work) noexcept {
  work.pivots = m;
  work.right.leftCols<kN>().setIdentity();
  auto inverse = work.right.leftCols<kN>();
  return solve_in_place(work.pivots, inverse);
}

/// Cayley transform of the Hamiltonian [A, -G; -H, -A'] with shift `gamma`, where doubling starts:
///   W = (A - gamma I)' + H (A - gamma I)^-1 G,
///   A_0 = I + 2 gamma W^-T, G_0 = 2 gamma (A - gamma I)^-1 G W^-1, H_0 = 2 gamma W^-1 H (A - gamma I)^-1.
[[nodiscard]] bool start_doubling(const StateMatrix& A, const StateMatrix& G, const StateMatrix& H,
                                  double gamma, CareWorkspace& work) noexcept {
  work.t = A;
  work.t.diagonal().array() -= gamma;
  if (!invert(work.t, work)) return false;
  work.Ak = work.right.leftCols<kN>();  // (A - gamma I)^-1
  multiply(work.Gk, work.Ak, G);
  multiply(work.u, H, work.Gk);
  work.u += work.t.transpose();  // W
  if (!invert(work.u, work)) return false;
  work.t = work.right.leftCols<kN>();  // W^-1
  multiply(work.u, work.Gk, work.t);
  work.Gk = 2.0 * gamma * work.u;
  multiply(work.u, H, work.Ak);
  multiply(work.Hk, work.t, work.u);
  work.Hk *= 2.0 * gamma;
  work.Ak = 2.0 * gamma * work.t.transpose();
  work.Ak.diagonal().array() += 1.0;
  symmetrise(work.Gk);
  symmetrise(work.Hk);
  return true;
}

/// With V = I + G H:  A <- A V^-1 A,  G <- G + A V^-1 G A',  H <- H + A'H V^-1 A.
[[nodiscard]] bool double_once(CareWorkspace& work) noexcept {
  multiply(work.pivots, work.Gk, work.Hk);
  work.pivots.diagonal().array() += 1.0;
  work.right.leftCols<kN>() = work.Ak;
  work.right.rightCols<kN>() = work.Gk;
  if (!solve_in_place(work.pivots, work.right)) return false;
  multiply(work.t, work.Hk, work.right.leftCols<kN>());
  multiply(work.u, work.Ak.transpose(), work.t);
  work.Hk += work.u;
  multiply(work.t, work.Ak, work.right.rightCols<kN>());
  multiply(work.u, work.t, work.Ak.transpose());
  work.Gk += work.u;
  multiply(work.t, work.Ak, work.right.leftCols<kN>());
  work.Ak = work.t;
  symmetrise(work.Gk);
  symmetrise(work.Hk);
  return true;
}

/// Writes the stabilising X of A'X + X A - X G X + H = 0 to work.Hk. False when the iteration does not end.
[[nodiscard]] bool solve_by_doubling(const StateMatrix& A, const StateMatrix& G, const StateMatrix& H,
                                     double gamma, CareWorkspace& work) noexcept {
  if (!start_doubling(A, G, H, gamma, work)) return false;
  for (int i = 0; i < kMostDoublings; ++i) {
    if (!double_once(work)) return false;
    const double norm = work.Ak.norm();
    if (!std::isfinite(norm) || !std::isfinite(work.Hk.norm())) return false;
    if (norm < kVanished) return true;
  }
  return false;
}

/// Computes work.residual = A'S + S A - S G S + Q and work.loop = A - G S. Returns the relative residual.
[[nodiscard]] double evaluate(const CareProblem& problem, const StateMatrix& S,
                              CareWorkspace& work) noexcept {
  multiply(work.t, work.G, S);
  work.loop = problem.A - work.t;
  multiply(work.u, S, work.t);
  double scale = work.u.norm() + problem.Q.norm();
  work.residual = problem.Q - work.u;
  multiply(work.u, S, problem.A);
  scale += 2.0 * work.u.norm();
  work.residual += work.u;
  work.residual += work.u.transpose();
  symmetrise(work.residual);
  return scale > 0.0 ? work.residual.norm() / scale : 0.0;
}

/// Newton-Kleinman steps S <- S + D with (A - G S)'D + D (A - G S) + residual = 0, as long as they reduce the
/// residual. False when a closed loop is unstable.
[[nodiscard]] bool refine(const CareProblem& problem, double gamma, CareSolution& solution,
                          CareWorkspace& work) noexcept {
  solution.residual = evaluate(problem, solution.S, work);
  for (int i = 0; i < kRefinements; ++i) {
    // With G = 0 doubling solves the Lyapunov equation; that it ends proves that the loop is stable.
    if (!solve_by_doubling(work.loop, StateMatrix::Zero(), work.residual, gamma, work)) return false;
    if (solution.residual <= kGoodResidual) return true;
    work.correction = solution.S + work.Hk;
    const double residual = evaluate(problem, work.correction, work);
    if (!(residual < solution.residual)) return true;
    solution.S = work.correction;
    solution.residual = residual;
  }
  return true;
}

[[nodiscard]] CareOutcome check(const CareProblem& problem) noexcept {
  if (!problem.A.allFinite() || !problem.B.allFinite() || !problem.Q.allFinite() || !problem.R.allFinite()) {
    return CareOutcome::not_finite;
  }
  for (int c = 0; c < kN; ++c) {
    if (problem.Q(c, c) < 0.0) return CareOutcome::bad_cost;
    for (int r = 0; r < c; ++r) {
      if (problem.Q(r, c) != problem.Q(c, r)) return CareOutcome::bad_cost;
    }
  }
  return positive_definite(problem.R) ? CareOutcome::ok : CareOutcome::bad_cost;
}

}  // namespace

CareOutcome solve_care(const CareProblem& problem, CareSolution& solution, CareWorkspace& work) noexcept {
  if (const CareOutcome outcome = check(problem); outcome != CareOutcome::ok) return outcome;
  InputWeight R = problem.R;
  FeedbackMatrix weighted = problem.B.transpose();  // R^-1 B'
  if (!solve_in_place(R, weighted)) return CareOutcome::bad_cost;
  multiply(work.G, problem.B, weighted);
  symmetrise(work.G);

  const double norm =
      std::sqrt(2.0 * problem.A.squaredNorm() + work.G.squaredNorm() + problem.Q.squaredNorm());
  for (const double factor : kShiftFactors) {
    const double gamma = factor * std::sqrt(norm);
    if (!solve_by_doubling(problem.A, work.G, problem.Q, gamma, work)) continue;
    solution.S = work.Hk;
    if (!refine(problem, gamma, solution, work)) continue;
    if (!(solution.residual <= kCareTolerance)) continue;
    multiply(solution.K, weighted, solution.S);
    STILT_ASSERT(solution.S == solution.S.transpose() && (solution.S.diagonal().array() >= 0.0).all());
    STILT_ASSERT(solution.K.allFinite());
    return CareOutcome::ok;
  }
  return CareOutcome::no_stabilising_solution;
}

}  // namespace stilt::lq
