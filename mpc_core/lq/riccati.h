#pragma once

#include "mpc_core/lq/lq_problem.h"

// clang-format off
/// Riccati recursion for the LQ problem of lq_problem.h. The cost to go of stage k+1 is
/// V(x) = 1/2 x' P x + p' x:
///
///   F = S + B'P A            f_x = q + A'(P b + p)
///   H = R + B'P B = L D L'   f_u = r + B'(P b + p)
///   K = -H^-1 F              k   = -H^-1 f_u
///   P <- Q + A'P A - F'H^-1 F        p <- f_x - F'H^-1 f_u
///
/// A = E + U G' in the form of lq_problem.h (U: unit columns and L). So products with A become products with
/// its 7 or 8 rows of G. With S = U'P U, and S_l its lower triangle with the diagonal halved,
///
///   A'P A = E'P E + W G' + G W'        W' = U'P E + S_l G'
///
/// Only the triangles Q[c][r], R[c][r] with r >= c are read. P is made exactly symmetric at every stage: the
/// antisymmetric part of a rounding error would otherwise grow with the open-loop dynamics. Real-time safe:
/// bounded time, no heap, no libm. The same input gives the same bits on the same build. Sources: Rawlings,
/// Mayne, Diehl, Model Predictive Control (2nd ed.), section 8.8.3; for the layout
/// docs/decisions/0002-riccati-sweep.md.
// clang-format on
namespace stilt::lq {

/// Result of one stage of the backward sweep.
enum class SweepOutcome {
  ok,
  not_positive_definite,  ///< R + B'P B is not positive definite: add to R and sweep again, or reject the
                          ///< step
  not_finite,             ///< NaN or infinity reached a pivot or the final cost to go
  bad_input_count,        ///< form, free_inputs and constraints match no contact mode
};

/// A pivot of L D L' counts as positive when it exceeds this fraction of its diagonal entry of R + B'P B. The
/// sweep adds nothing to the matrix: it reports a smaller pivot, and the caller decides.
inline constexpr double kSmallestRelativePivot = 1e-13;

/// Cost to go 1/2 x' P x + p' x of one stage, up to a constant.
struct alignas(64) ValueFunction {
  double P[kStates][kRows];  ///< symmetric, padding zero
  double p[kRows];
};

/// Scratch of the sweep (about 8 kB); contents need not be initialised.
struct alignas(64) RiccatiWorkspace {
  ValueFunction value[2];                                 ///< of this stage and the next, alternating
  double M[model::kJoints][kRows];                        ///< columns of value_products in riccati.cc
  double X[kMaxFreeInputs + kMaxConstraints + 1][kRows];  ///< P [L, B] by columns, then P b + p
  double W[kMaxDynamicsRows][kRows];                      ///< W' by rows
  double F[kMaxFreeInputs + 1][kRows];                    ///< F by rows, then f_x
  double y[kMaxFreeInputs][kRows];                        ///< L^-1 F by rows
  double half_y[kMaxFreeInputs][kRows];
  double z[kMaxFreeInputs][kRows];  ///< -D^-1 L^-1 F by rows
  double dots[32];                  ///< [L, B]'X, see Dots in riccati.cc
};

/// The backward sweep, stage by stage: each stage can be computed just before it is used, while it is in the
/// nearest cache.
class BackwardSweep {
 public:
  BackwardSweep(const LqTerminal& terminal, RiccatiWorkspace& workspace) noexcept;

  /// Computes the gain of the stage before those already swept; its entries beyond free_inputs are zero.
  /// Flows have (free inputs, constraints) = (3, 1) in single support, (4, 2) in double support, (2, 2) in
  /// flight; transitions have neither. After any outcome but ok the sweep must not continue.
  [[nodiscard]] SweepOutcome step(const LqFirstOrder& first, const LqSecondOrder& second,
                                  LqGain& gain) noexcept;

  /// Cost to go from the stage swept last.
  [[nodiscard]] const ValueFunction& value() const noexcept { return *value_; }
  [[nodiscard]] bool finite() const noexcept;  ///< whether value() is finite

 private:
  RiccatiWorkspace& workspace_;
  ValueFunction* value_;
};

/// Computes the solution forwards. x_{k+1} = A x + B w + b with w = k + K x, c = rows 6, 7 of G x, and the
/// input's step u behind w. Returns the first-order change of the cost along the steps, the sum of q'x,
/// r'w and the slopes along u0. It is the slope for Armijo's condition.
/// \param stages  `count` stages, accepted by the backward sweep, and their inputs
/// \param x0      kRows values, padding zero
/// \param steps   output, count + 1 steps; w and c are zero beyond the counts of a stage and in the last
///                step, which has no u
[[nodiscard]] double forward_sweep(const LqFirstOrder* stages, const InputProjection* inputs, int count,
                                   const LqTerminal& terminal, const LqGain* gains, const double* x0,
                                   LqStep* steps) noexcept;

}  // namespace stilt::lq
