#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/ocp/problem.h"
#include "mpc_core/solver/riccati.h"

/// What the measurements know of the memory layout of the solver's quadratic model; all of it is here.
namespace stilt::benchmark {

/// Room for the quadratic model of any planning problem. Large: to be placed on the heap.
class LinearisedProblem {
 public:
  LinearisedProblem() : stages_(ocp::kMaxStages), projections_(ocp::kMaxStages) {}

  /// Linearises all stages around the iterate.
  void linearise(const ocp::ProblemData& data, const ocp::Problem& problem,
                 const ocp::Trajectory& iterate) noexcept {
    ocp::linearise(data, problem, iterate, stages_.data(), projections_.data(), terminal_);
  }

  [[nodiscard]] const solver::LqStage* stages() const noexcept { return stages_.data(); }
  [[nodiscard]] const solver::LqStage& stage(int k) const noexcept {
    return stages_[static_cast<std::size_t>(k)];
  }
  [[nodiscard]] const solver::LqTerminal& terminal() const noexcept { return terminal_; }

 private:
  std::vector<solver::LqStage> stages_;
  std::vector<ocp::InputProjection> projections_;
  solver::LqTerminal terminal_;
};

using StateMatrix = Eigen::Matrix<double, solver::kStates, solver::kStates>;

/// A of x_{k+1} = A x + B w + b.
[[nodiscard]] inline StateMatrix dense_dynamics(const solver::LqStage& stage) {
  StateMatrix A;
  for (int c = 0; c < solver::kStates; ++c) {
    for (int r = 0; r < solver::kStates; ++r) A(r, c) = stage.A[c][r];
  }
  return A;
}

}  // namespace stilt::benchmark
