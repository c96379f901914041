#pragma once

#include <cstddef>
#include <vector>

#include "host_tools/benchmark/work_table.h"

namespace stilt::benchmark {

/// What one plan in closed loop took, and what its work consisted of.
struct PlanSample {
  double time_s = 0.0;  ///< simulated time of the plan
  double solve_us = 0.0;
  bool preempted = false;  ///< the operating system took the processor away during the plan
  int stages = 0;
  int transitions = 0;            ///< stages that are touch-downs
  int double_support_stages = 0;  ///< stages with one more free input
  int iterations = 0;
  int trial_steps = 0;         ///< of all line searches together; as many as iterations when none backtracks
  long long instructions = 0;  ///< in linearisations, sweeps and evaluations
};

/// Fills in all but times and preemption, from the problem that the planner solved last and the report of
/// this solve.
void describe_work(const control::Planner& planner, const sqp::SolveReport& report, WorkTable& table,
                   PlanSample& sample);

struct Tail {
  double p50 = 0.0, p99 = 0.0, p999 = 0.0, max = 0.0;

  /// p99.9 over p50.
  [[nodiscard]] double ratio() const noexcept { return p50 > 0.0 ? p999 / p50 : 0.0; }
};

/// Nearest-rank percentiles; zeros without values.
[[nodiscard]] Tail tail(std::vector<double> values);

/// The `count` samples with the most instructions, most first; of equal ones the earlier first.
[[nodiscard]] std::vector<PlanSample> worst(std::vector<PlanSample> samples, std::size_t count);

}  // namespace stilt::benchmark
