#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "mpc_core/solver/riccati.h"

/// Seeded random LQ problems and what a test knows about their solution independently of the sweep.
namespace stilt::solver::testing {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

struct LqProblem {
  std::vector<LqStage> stages;
  LqTerminal terminal{};
  alignas(64) double x0[kRows]{};

  [[nodiscard]] int count() const { return static_cast<int>(stages.size()); }
};

struct LqSolution {
  std::vector<LqGain> gains;
  std::vector<ValueFunction> values;
  std::vector<LqStep> steps;
};

/// Plain Eigen copies of a stage's matrices, cut to their true sizes.
struct PlainStage {
  Matrix A, B, Q, S, R;
  Vector b, q, r;
};
[[nodiscard]] PlainStage plain(const LqStage& stage);
[[nodiscard]] Matrix plain_terminal_hessian(const LqTerminal& terminal);
[[nodiscard]] Vector plain_state(const double* padded);

/// Dynamics with spectral radius about `radius`, convex cost with a positive definite R.
[[nodiscard]] LqStage random_stage(std::mt19937_64& random, int free_inputs, double radius);
/// `count` stages with free inputs drawn from 0, 2, 3, 4 and a common spectral radius in [0.5, 1.05].
[[nodiscard]] LqProblem random_problem(std::uint64_t seed, int count);

/// Backward and forward sweep; the status is returned through `status`.
[[nodiscard]] LqSolution solve(const LqProblem& problem, SweepStatus& status);

/// Largest residuals of the KKT conditions, each entry relative to the terms of its own equation. Costates
/// are lambda_k = P_k x_k + p_k with the cost to go the sweep returned.
struct KktResidual {
  double state = 0.0;     ///< Q x + q + S'w + A'lambda_{k+1} - lambda_k
  double input = 0.0;     ///< R w + r + S x + B'lambda_{k+1}
  double dynamics = 0.0;  ///< A x + B w + b - x_{k+1}

  [[nodiscard]] double worst() const { return std::max({state, input, dynamics}); }
};
[[nodiscard]] KktResidual kkt_residual(const LqProblem& problem, const LqSolution& solution);

/// All steps of the solution, [w_0, x_1, w_1, x_2, ... x_N], from one dense LU of the KKT matrix.
[[nodiscard]] Vector dense_kkt_solution(const LqProblem& problem);

}  // namespace stilt::solver::testing
