#pragma once

#include <cstddef>
#include <vector>

#include "host_tools/benchmark/work_table.h"

namespace stilt::benchmark {

/// Duration of one plan in closed loop, and the work that it consisted of.
struct PlanSample {
  double time_s = 0.0;  ///< simulated time of the plan
  double solve_us = 0.0;
  bool preempted = false;  ///< the operating system preempted the plan
  int stages = 0;
  int transitions = 0;            ///< number of stages that are touch-downs
  int double_support_stages = 0;  ///< number of stages with one more free input
  int iterations = 0;
  int trial_steps = 0;         ///< over all line searches; equal to the iterations without backtracking
  long long instructions = 0;  ///< of linearisations, sweeps and evaluations
};

/// Fills in all fields but times and preemption, from the last problem of the planner and the report of its
/// solve.
void describe_work(const control::Planner& planner, const sqp::SolveReport& report, WorkTable& table,
                   PlanSample& sample);

/// Percentiles of a list of values.
struct Tail {
  double p50 = 0.0, p99 = 0.0, p999 = 0.0, max = 0.0;

  /// Ratio of p99.9 to p50.
  [[nodiscard]] double ratio() const noexcept { return p50 > 0.0 ? p999 / p50 : 0.0; }
};

/// Nearest-rank percentiles; zeros for an empty list.
[[nodiscard]] Tail tail(std::vector<double> values);

/// The `count` samples with the most instructions, in descending order; of equal samples the earlier one
/// first.
[[nodiscard]] std::vector<PlanSample> worst(std::vector<PlanSample> samples, std::size_t count);

}  // namespace stilt::benchmark
