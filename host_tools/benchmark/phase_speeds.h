#pragma once

#include "host_tools/benchmark/planner_kernels.h"
#include "host_tools/benchmark/work_table.h"

namespace stilt::benchmark {

/// Speed of one phase of an SQP iteration.
struct PhaseSpeed {
  double time_us = 0.0;
  ExecutedWork work;
  double rate_gflop_s = 0.0;
  double peak_share = 0.0;
};

/// Speeds of the phases on one problem and the machine's peak, measured in turns.
struct PhaseSpeeds {
  double peak_gflop_s = 0.0;
  PhaseSpeed linearise;
  PhaseSpeed sweep;  ///< time of linearise_and_sweep() beyond that of linearise()
  PhaseSpeed evaluate;
  double textbook_sweep_share = 0.0;  ///< share of the peak, counting textbook_sweep_flops() instead
};

/// Measures medians over that many rounds (a fraction of a millisecond each). `work`: work of one run of each
/// phase.
[[nodiscard]] PhaseSpeeds measure_phases(PlannerKernels& kernels, const IterationWork& work, int rounds);

}  // namespace stilt::benchmark
