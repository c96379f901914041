#pragma once

#include "mpc_core/lq/care.h"
#include "mpc_core/ocp/problem_data.h"

namespace stilt::sqp {

/// Weight of the products of state and input.
using CrossWeight = Eigen::Matrix<double, model::kStates, model::kInputs>;

/// Scratch of set_terminal_cost (about 30 kB); contents need not be initialised.
struct TerminalCostWorkspace {
  lq::CareProblem problem;
  CrossWeight cross;
  lq::CareSolution solution;
  lq::CareWorkspace care;
};

/// Computes the terminal weight rho S. S solves the continuous-time algebraic Riccati equation for the
/// linearisation
///   x' = A x + B u   of   x' = [v; a_b(x, u); u_j]
/// at a standing posture (forces sharing the weight), with the running weights Q and R of state
/// and input. When cost.terminal_feet is true, the weights of the feet are included: the whole of equation 14
/// of Galliker et al. 2022. Their accelerations depend on state and input, which adds a weight of the
/// products. Joint accelerations and both feet's forces count as free inputs, so that every state is
/// controllable. Writes data.terminal_weight, which is zero when rho is zero. False when no stabilising
/// solution was found. Takes milliseconds: for start-up and changes of weights, not for the real-time path.
[[nodiscard]] bool set_terminal_cost(ocp::ProblemData& data, const model::StateVector& standing,
                                     TerminalCostWorkspace& work) noexcept;

}  // namespace stilt::sqp
