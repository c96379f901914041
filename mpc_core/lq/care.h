#pragma once

#include <Eigen/Core>

#include "mpc_core/model/types.h"

/// Continuous-time algebraic Riccati equation (CARE) for 14 states and 8 inputs:
///
///   A'S + S A - S B R^-1 B' S + Q = 0,   A - B K stable with K = R^-1 B'S.
///
/// x'S x / 2 is the cost to go of x' = A x + B u with the integrand (x'Q x + u'R u) / 2. The optimal
/// feedback is u = -K x.
///
/// Method: structure-preserving doubling, then Newton-Kleinman steps. The same doubling solves the Lyapunov
/// equations of those steps (the case B = 0). Doubling ends when a power of the closed loop's Cayley
/// transform has vanished, which also proves that the closed loop is stable. Sources: Chu, Fan, Lin, "A
/// structure-preserving doubling algorithm for continuous-time algebraic Riccati equations", Linear Algebra
/// and its Applications 396 (2005); Kleinman, IEEE Trans. Automatic Control 13 (1968).
///
/// No heap, no exceptions, bounded work (about a millisecond): for start-up and changes of weights. Not for
/// the torque loop.
namespace stilt::lq {

using StateMatrix = Eigen::Matrix<double, model::kStates, model::kStates>;
using InputMatrix = Eigen::Matrix<double, model::kStates, model::kInputs>;
using InputWeight = Eigen::Matrix<double, model::kInputs, model::kInputs>;
using FeedbackMatrix = Eigen::Matrix<double, model::kInputs, model::kStates>;

/// Data of the CARE.
struct CareProblem {
  StateMatrix A;
  InputMatrix B;
  StateMatrix Q;  ///< symmetric, positive semidefinite
  InputWeight R;  ///< symmetric, positive definite
};

/// Solution of the CARE.
struct CareSolution {
  StateMatrix S;     ///< symmetric
  FeedbackMatrix K;  ///< u = -K x
  double residual;   ///< |left-hand side| / (2 |A'S| + |S B R^-1 B'S| + |Q|), Frobenius norms
};

/// Result of solve_care().
enum class CareOutcome {
  ok,
  bad_cost,                 ///< Q not symmetric or with a negative diagonal, or R not positive definite
  not_finite,               ///< NaN or infinity in the problem
  no_stabilising_solution,  ///< B cannot reach an unstable or marginal mode, or Q a marginal one
};

/// Largest residual returned with ok, relative (see CareSolution).
inline constexpr double kCareTolerance = 1e-10;

/// Scratch of solve_care (about 20 kB); contents need not be initialised.
struct CareWorkspace {
  StateMatrix G;  ///< B R^-1 B'
  StateMatrix residual, loop, correction;
  StateMatrix Ak, Gk, Hk;  ///< the doubling's three sequences
  StateMatrix t, u;        ///< products
  StateMatrix pivots;      ///< left-hand side of a linear solve, overwritten by it
  Eigen::Matrix<double, model::kStates, 2 * model::kStates> right;  ///< its right-hand sides, then solutions
};

/// Solves the CARE. `solution` is meaningful only when the outcome is ok.
[[nodiscard]] CareOutcome solve_care(const CareProblem& problem, CareSolution& solution,
                                     CareWorkspace& work) noexcept;

}  // namespace stilt::lq
