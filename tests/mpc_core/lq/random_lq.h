#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "host_tools/benchmark/lq_stage.h"
#include "mpc_core/lq/riccati.h"
#include "tests/mpc_core/lq/dense_stage.h"

/// Seeded random LQ problems and facts about their solution that do not depend on the sweep.
namespace stilt::lq::testing {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using benchmark::LqStage;

struct LqProblem {
  std::vector<LqStage> stages;
  std::vector<InputProjection> inputs;
  LqTerminal terminal{};
  alignas(64) double x0[kRows]{};

  [[nodiscard]] int count() const { return static_cast<int>(stages.size()); }
  /// What the forward sweep reads, in a row.
  [[nodiscard]] std::vector<LqFirstOrder> first_orders() const { return {stages.begin(), stages.end()}; }
};

/// How a backward sweep over all stages ended.
struct SweepStatus {
  SweepOutcome outcome = SweepOutcome::ok;
  int stage = -1;  ///< where it was noticed; the cause of not_finite may lie at any later stage

  [[nodiscard]] bool ok() const { return outcome == SweepOutcome::ok; }
};

struct LqSolution {
  std::vector<LqGain> gains;
  std::vector<ValueFunction> values;
  std::vector<LqStep> steps;
  double slope = 0.0;
};

/// Plain Eigen copies of a stage's matrices, cut to their true sizes; A as the dense sum of its factors.
struct DenseStage {
  Matrix A, B, Q, S, R;
  Vector b, q, r;
};
[[nodiscard]] DenseStage dense(const LqStage& stage);
[[nodiscard]] Matrix baseline_terminal_hessian(const LqTerminal& terminal);
[[nodiscard]] Vector dense_state(const double* padded);

/// What the sweep has kernels for.
struct StageKind {
  StageForm form;
  int free_inputs;
  int constraints;
};
inline constexpr StageKind kSingleSupport{StageForm::flow, 3, 1};
inline constexpr StageKind kDoubleSupport{StageForm::flow, 4, 2};
inline constexpr StageKind kFlight{StageForm::flow, 2, 2};
inline constexpr StageKind kTransition{StageForm::transition, 0, 0};
inline constexpr StageKind kKinds[] = {kTransition, kFlight, kSingleSupport, kDoubleSupport};

/// Dynamics with normal entries, of deviation `coupling` in G and 1 in L and B, and h between 2 and 30 ms.
/// Convex cost with a positive definite R.
[[nodiscard]] LqStage random_stage(std::mt19937_64& random, StageKind kind, double coupling);
/// Adds a stage with random_stage() and a random projection of its inputs. What its kind lacks is NaN, and
/// may not be read.
void add_stage(std::mt19937_64& random, StageKind kind, double coupling, LqProblem& problem);
/// `count` stages of kinds drawn from kKinds and a common coupling in [0.02, 0.3].
[[nodiscard]] LqProblem random_problem(std::uint64_t seed, int count);

/// The backward sweep over all stages; `values`: null, or room for the count + 1 cost-to-go functions.
[[nodiscard]] SweepStatus backward_sweep(const LqProblem& problem, LqGain* gains, RiccatiWorkspace& workspace,
                                         ValueFunction* values = nullptr);

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

}  // namespace stilt::lq::testing
