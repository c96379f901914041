#pragma once

#include <vector>

#include "mpc_core/lq/riccati.h"
#include "mpc_core/ocp/linearise.h"
#include "mpc_core/ocp/problem.h"

namespace stilt::benchmark {

/// Room for the quadratic model of any planning problem. Large: to be placed on the heap.
class LinearisedProblem {
 public:
  LinearisedProblem() : stages_(ocp::kMaxStages), projections_(ocp::kMaxStages) {}

  /// Linearises all stages around the iterate.
  void linearise(const ocp::ProblemData& data, const ocp::Problem& problem,
                 const ocp::Trajectory& iterate) noexcept {
    ocp::linearise(data, problem, iterate, stages_.data(), projections_.data(), terminal_, workspace_);
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
  ocp::LineariseWorkspace workspace_;
};

}  // namespace stilt::benchmark
