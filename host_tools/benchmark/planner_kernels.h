#pragma once

#include <vector>

#include "host_tools/benchmark/linearised_problem.h"
#include "mpc_core/control/planner.h"
#include "mpc_core/dispatch/dispatched_planner.h"

namespace stilt::benchmark {

/// The planner behind it when that is the one for the instruction set of the whole program; otherwise null.
/// The kernels and the counting of their work are compiled for that set.
[[nodiscard]] const control::Planner* planner_of_build(const dispatch::DispatchedPlanner& planner) noexcept;

/// The last problem of a planner, at its solution, with every kernel of the solver ready to run alone. Large:
/// place it on the heap.
class PlannerKernels {
 public:
  /// Copies problem and solution. The planner must have solved at least one problem.
  explicit PlannerKernels(const control::Planner& planner);

  /// The phases of one SQP iteration, as the planner runs them.
  void linearise();            ///< all stages
  void linearise_and_sweep();  ///< all stages, each swept as soon as it is linearised; then the forward sweep
  void evaluate();             ///< cost and violation of one trial step

  /// Both sweeps alone, over stages linearised before.
  void sweep();
  void backward_sweep();

  /// Inputs of the kernels.
  [[nodiscard]] const ocp::ProblemData& data() const noexcept { return data_; }
  [[nodiscard]] const ocp::Problem& problem() const noexcept { return problem_; }
  [[nodiscard]] const ocp::Trajectory& iterate() const noexcept { return iterate_; }
  [[nodiscard]] const LinearisedProblem& linearised() const noexcept { return linearised_; }

  [[nodiscard]] int stages() const noexcept { return problem_.horizon.stages; }

  /// Sum of textbook_sweep_flops() over all stages.
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

/// Least number of floating-point operations of the recursion in riccati.h per stage, for 14 states and m
/// inputs: dense matrices, one triangle of symmetric ones. A product and a sum count as two.
[[nodiscard]] long long textbook_sweep_flops(int free_inputs) noexcept;

}  // namespace stilt::benchmark
