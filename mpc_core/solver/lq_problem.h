#pragma once

#include "mpc_core/model/types.h"

/// The quadratic subproblem of one SQP iteration, after the equality constraints have been projected out:
///
///   minimise  sum_k 1/2 x_k' Q_k x_k + q_k' x_k + 1/2 w_k' R_k w_k + r_k' w_k + w_k' S_k x_k
///             + 1/2 x_N' Q_N x_N + q_N' x_N
///   subject to x_{k+1} = A_k x_k + B_k w_k + b_k,  x_0 given
///
/// where x (14) is the step of the state and w the step along the free directions of the input: 3 in single
/// support, 4 in double support, 2 in flight, 0 at a contact transition.
///
/// Matrices are stored by columns of kRows = 16 doubles (14 used, the padding is zero), so that a column is a
/// whole number of SIMD registers.
namespace stilt::solver {

inline constexpr int kStates = model::kStates;
inline constexpr int kRows = 16;
inline constexpr int kMaxFreeInputs = 4;

struct alignas(64) LqStage {
  double A[kStates][kRows];         ///< A[column][row]
  double Q[kStates][kRows];         ///< symmetric, both halves filled
  double B[kMaxFreeInputs][kRows];  ///< B[column][row]
  double S[kMaxFreeInputs][kRows];  ///< S[input][state]
  double b[kRows];                  ///< defect of the dynamics
  double q[kRows];
  double R[kMaxFreeInputs][kMaxFreeInputs];
  double r[kMaxFreeInputs];
  int free_inputs;  ///< 0 to kMaxFreeInputs; rows and columns beyond are not read
};

struct alignas(64) LqTerminal {
  double Q[kStates][kRows];
  double q[kRows];
};

/// Optimal free input of a stage: w = k + K x.
struct alignas(64) LqGain {
  double K[kMaxFreeInputs][kRows];  ///< K[input][state]
  double k[kMaxFreeInputs];
};

/// Solution of a stage.
struct alignas(64) LqStep {
  double x[kRows];
  double w[kMaxFreeInputs];
};

}  // namespace stilt::solver
