#pragma once

#include <vector>

#include "host_tools/benchmark/linearised_problem.h"
#include "mpc_core/control/planner.h"

namespace stilt::benchmark {

/// The problem that a planner solved last, at its solution, with every kernel of the solver ready to be run
/// alone. Large: to be placed on the heap.
class PlannerKernels {
 public:
  /// Copies problem and solution; the planner must have planned.
  explicit PlannerKernels(const control::Planner& planner);

  /// The phases of one SQP iteration, as the planner runs them.
  void linearise();            ///< all stages
  void linearise_and_sweep();  ///< all stages, each swept when it is linearised; then the forward sweep
  void evaluate();             ///< cost and violation of one trial step

  /// Both sweeps alone, over stages that were linearised before.
  void sweep();
  void backward_sweep();

  /// What the kernels work on.
  [[nodiscard]] const ocp::ProblemData& data() const noexcept { return data_; }
  [[nodiscard]] const ocp::Problem& problem() const noexcept { return problem_; }
  [[nodiscard]] const ocp::Trajectory& iterate() const noexcept { return iterate_; }
  [[nodiscard]] const LinearisedProblem& linearised() const noexcept { return linearised_; }

  [[nodiscard]] int stages() const noexcept { return problem_.horizon.stages; }

  /// textbook_sweep_flops() of all stages.
  [[nodiscard]] long long textbook_sweep_flops() const noexcept;

 private:
  ocp::ProblemData data_;
  ocp::Problem problem_;
  ocp::Trajectory iterate_;
  ocp::StageModels models_;
  LinearisedProblem linearised_;
  std::vector<lq::LqFirstOrder> first_orders_;
  std::vector<lq::LqGain> gains_;
  std::vector<lq::LqStep> steps_;
  lq::RiccatiWorkspace workspace_;
  alignas(64) double x0_[lq::kRows] = {};
};

/// Floating-point operations of the recursion in riccati.h at its least: dense matrices, symmetric ones by
/// their triangle, a product and a sum counting as two. For 14 states and m inputs, per stage.
[[nodiscard]] long long textbook_sweep_flops(int free_inputs) noexcept;

}  // namespace stilt::benchmark
