#pragma once

#include "host_tools/benchmark/planner_kernels.h"
#include "tests/benchmarks/baseline_linearise.h"
#include "tests/benchmarks/baseline_sweep.h"

namespace stilt::benchmark {

/// Baselines of the work of a planner's kernels, on the same data. Large: to be placed on the heap.
class BaselineKernels {
 public:
  /// Copies problem and solution.
  explicit BaselineKernels(const PlannerKernels& kernels);

  void sweep() { sweep_.run(); }  ///< backward only, in fixed-size Eigen
  void linearise();               ///< all flow stages, node by node in fixed-size Eigen
  void scalar_nodes();            ///< generated derivatives of all flow stages, one by one
  void batched_nodes();           ///< the same, a batch at a time

 private:
  ocp::ProblemData data_;
  ocp::Problem problem_;
  ocp::Trajectory iterate_;
  BaselineSweep sweep_;
  BaselineModel model_;
};

}  // namespace stilt::benchmark
