#pragma once

#include "mpc_core/lq/lq_problem.h"

/// Riccati recursion for the LQ problem of lq_problem.h. With the cost to go of stage k+1
/// V(x) = 1/2 x' P x + p' x:
///
///   F = S + B'P A            f_x = q + A'(P b + p)
///   H = R + B'P B = L D L'   f_u = r + B'(P b + p)
///   K = -H^-1 F              k   = -H^-1 f_u
///   P <- Q + A'P A - F'H^-1 F        p <- f_x - F'H^-1 f_u
///
/// With A = E + U G' in the form of lq_problem.h (U: unit columns and L) products with A become products with
/// its 6 to 8 rows of G. With S = U'P U, halved on the diagonal and cut to its lower triangle in S_l,
///
///   A'P A = E'P E + W G' + G W'        W' = U'P E + S_l G'
///
/// Of Q and R only the triangles Q[c][r], R[c][r] with r >= c are read, and P is made exactly symmetric at
/// every stage: the antisymmetric part of a rounding error would otherwise grow with the open-loop dynamics.
/// Real-time safe: bounded time, no heap, no libm. The same input gives the same bits on the same build.
/// Source: Rawlings, Mayne, Diehl, Model Predictive Control (2nd ed.), section 8.8.3; layout in
/// docs/decisions/0002-riccati-sweep.md.
namespace stilt::lq {

enum class SweepOutcome {
  ok,
  not_positive_definite,  ///< R + B'P B is not positive definite: add to R and sweep again, or reject the
                          ///< step
  not_finite,             ///< NaN or infinity reached a pivot or the final cost to go
  bad_input_count,        ///< form, free_inputs and constraints are not those of a contact mode
};

/// A pivot of L D L' counts as positive when it exceeds this fraction of its diagonal entry of R + B'P B.
/// Nothing is ever added to the matrix: a smaller pivot is reported and the caller decides.
inline constexpr double kSmallestRelativePivot = 1e-13;

/// Cost to go 1/2 x' P x + p' x of one stage, up to a constant.
struct alignas(64) ValueFunction {
  double P[kStates][kRows];  ///< symmetric, padding zero
  double p[kRows];
};

/// Everything the sweep writes besides its results (about 8 kB); contents need not be initialised.
struct alignas(64) RiccatiWorkspace {
  ValueFunction value[2];                                 ///< of this stage and the next, in turn
  double X[kMaxFreeInputs + kMaxConstraints + 1][kRows];  ///< P [B, L] by columns, then P b + p
  double W[kMaxDynamicsRows][kRows];                      ///< W' by rows
  double F[kMaxFreeInputs + 1][kRows];                    ///< F by rows, then f_x
  double y[kMaxFreeInputs][kRows];                        ///< L^-1 F by rows
  double half_y[kMaxFreeInputs][kRows];
  double z[kMaxFreeInputs][kRows];  ///< -D^-1 L^-1 F by rows
  double dots[32];                  ///< [B, L]'X, see Dots in riccati.cc
};

/// The backward sweep, stage by stage, so that each stage can be made just before it is used, while it is in
/// the nearest cache.
class BackwardSweep {
 public:
  BackwardSweep(const LqTerminal& terminal, RiccatiWorkspace& workspace) noexcept;

  /// Computes the gain of the stage before those taken so far; its entries beyond free_inputs are zero.
  /// Flows have (free inputs, constraints) = (3, 1) in single support, (4, 2) in double support, (2, 2) in
  /// flight; transitions have neither. After anything but ok the sweep is spoilt.
  [[nodiscard]] SweepOutcome step(const LqFirstOrder& first, const LqSecondOrder& second,
                                  LqGain& gain) noexcept;

  /// Cost to go from the stage of the newest step.
  [[nodiscard]] const ValueFunction& value() const noexcept { return *value_; }
  [[nodiscard]] bool finite() const noexcept;  ///< whether value() is

 private:
  RiccatiWorkspace& workspace_;
  ValueFunction* value_;
};

/// Rolls the solution out: x_{k+1} = A x + B w + b with w = k + K x, c = rows 6, 7 of G x.
/// \param stages  `count` stages, accepted by the backward sweep
/// \param x0      kRows values, padding zero
/// \param steps   count + 1 steps, written; w and c beyond the counts of a stage, and those of the last step,
///                are zero
void forward_sweep(const LqFirstOrder* stages, int count, const LqGain* gains, const double* x0,
                   LqStep* steps) noexcept;

/// First-order change of the cost along the steps, sum of q'x + r'w: the slope for Armijo's condition.
[[nodiscard]] double cost_slope(const LqFirstOrder* stages, int count, const LqTerminal& terminal,
                                const LqStep* steps) noexcept;

}  // namespace stilt::lq
