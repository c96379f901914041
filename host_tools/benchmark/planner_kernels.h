#pragma once

#include <vector>

#include "host_tools/benchmark/linearised_problem.h"
#include "host_tools/benchmark/plain_linearise.h"
#include "host_tools/benchmark/plain_sweep.h"
#include "mpc_core/control/planner.h"

namespace stilt::benchmark {

/// The problem that a planner solved last, at its solution, with every kernel of the solver ready to be run
/// alone, and plain versions of the same work beside them. Large: to be placed on the heap.
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

  /// Plain versions on the same data.
  void plain_sweep() { plain_.run(); }  ///< backward only, in fixed-size Eigen
  void plain_linearise();               ///< all flow stages, node by node in fixed-size Eigen
  void scalar_nodes();                  ///< generated derivatives of all flow stages, one by one
  void batched_nodes();                 ///< the same, a batch at a time

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
  PlainSweep plain_;
  PlainModel plain_model_;
};

/// Floating-point operations of the recursion in riccati.h at its least: dense matrices, symmetric ones by
/// their triangle, a product and a sum counting as two. For 14 states and m inputs, per stage.
[[nodiscard]] long long textbook_sweep_flops(int free_inputs) noexcept;

}  // namespace stilt::benchmark
