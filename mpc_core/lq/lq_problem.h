#pragma once

#include "mpc_core/model/types.h"

/// The quadratic subproblem of one SQP iteration, after projection of the equality constraints:
///
///   minimise  sum_k 1/2 x_k' Q_k x_k + q_k' x_k + 1/2 w_k' R_k w_k + r_k' w_k + w_k' S_k x_k
///             + 1/2 x_N' Q_N x_N + q_N' x_N
///   subject to x_{k+1} = A_k x_k + B_k w_k + b_k,  x_0 given
///
/// x (14) is the step of the state and w the step along the free directions of the input. There are 3 in
/// single support, 4 in double support, 2 in flight, 0 at a contact transition.
///
/// A is never formed. The joints are double integrators whose accelerations are inputs. A therefore differs
/// from the free motion E in the base rows. Through the equality constraints it differs along one or two
/// directions of the joints, too:
///
///   A = E + sum_{i < 6} e_row(i) G_i' + sum_{i >= 6} L_{i-6} G_i'     E = [I  h I; 0  I]
///
/// row(i) are the base rows 0, 1, 2 (position) and 7, 8, 9 (velocity); each term of the second sum is one
/// constraint. G has 7 rows in single support, 8 in double support and flight. A contact transition has h = 0
/// and row(i) = 7 + i, i < 7: an impact changes only velocities.
///
/// w and the constraints move the joints by constant accelerations over the interval. Each column of B and L
/// therefore has h/2 times the entry of a joint's velocity at its position. L is zero in the rows of the
/// base.
///
/// Vectors over the state are kRows = 16 doubles (14 used, the padding is zero), a whole number of SIMD
/// registers.
namespace stilt::lq {

inline constexpr int kStates = model::kStates;
inline constexpr int kRows = 16;
inline constexpr int kMaxFreeInputs = 4;

/// Form of the dynamics of a stage.
enum class StageForm : int {
  flow,        ///< unit rows 0, 1, 2, 7, 8, 9, then `constraints` rank-one terms L_i G_{6+i}'
  transition,  ///< unit rows 7 to 13; no inputs, no constraints, h = 0
};

inline constexpr int kBaseRows = 6;                             ///< unit rows of a flow
inline constexpr int kBaseRow[kBaseRows] = {0, 1, 2, 7, 8, 9};  ///< their rows of the state
inline constexpr int kMaxConstraints = 2;
inline constexpr int kMaxDynamicsRows = kBaseRows + kMaxConstraints;

/// Dynamics and gradient of a stage, as read by the forward sweep.
struct alignas(64) LqFirstOrder {
  double G[kMaxDynamicsRows][kRows];  ///< G[row][state]; column 0 (x_b) is zero: no term depends on x_b
  double L[kMaxConstraints][kRows];   ///< L[constraint][state row]
  double B[kMaxFreeInputs][kRows];    ///< B[column][row]
  double b[kRows];                    ///< defect of the dynamics
  double q[kRows];
  double r[kMaxFreeInputs];
  double h;  ///< s
  StageForm form;
  int constraints;  ///< 0 to kMaxConstraints
  int free_inputs;  ///< 0 to kMaxFreeInputs; entries beyond are not read
};

/// The input behind w, whose step is a function of the steps of the state and of the free directions:
///
///   du = u0 + Y c + W w + [0; F x; 0]
///
/// c are the products of the stage's constraint rows with x (LqStep::c). F are the rows of the force that the
/// stance constraint fixes, at u[first_force] and the next entry; single and double support have it. Columns
/// of eight inputs. u0 leads onto the equality constraints; the cost above does not contain it.
struct alignas(64) InputProjection {
  double u0[model::kInputs];
  double Y[kMaxConstraints][model::kInputs];
  double W[kMaxFreeInputs][model::kInputs];
  double F[2][kRows];
  double u0_slope;  ///< first-order change of the stage's cost along u0
  int first_force;  ///< -1: no foot on the ground, or no flow
};

/// Hessian of a stage's cost; the backward sweep reads it once.
struct alignas(64) LqSecondOrder {
  double Q[kStates][kRows];                  ///< Q[column][row], symmetric; only row >= column is read
  double S[kMaxFreeInputs][kRows];           ///< S[input][state]
  double R[kMaxFreeInputs][kMaxFreeInputs];  ///< only R[i][j] with j >= i is read
};

/// Terminal cost 1/2 x_N' Q x_N + q' x_N, in the layout of LqSecondOrder and LqFirstOrder.
struct alignas(64) LqTerminal {
  double Q[kStates][kRows];
  double q[kRows];
};

/// Optimal free input of a stage: w = k + K x.
struct alignas(64) LqGain {
  double K[kMaxFreeInputs][kRows];  ///< K[input][state]
  double k[kMaxFreeInputs];
};

/// Solution of one stage.
struct alignas(64) LqStep {
  double x[kRows];
  double w[kMaxFreeInputs];
  double c[kMaxConstraints];  ///< G_{6+i} x of a flow: what constraint i requires of the joints
  alignas(64) double u[model::kInputs];
};

}  // namespace stilt::lq
