#pragma once

#include "host_tools/benchmark/planner_kernels.h"
#include "host_tools/benchmark/work_table.h"

namespace stilt::benchmark {

/// How fast one phase of an SQP iteration runs.
struct PhaseSpeed {
  double time_us = 0.0;
  ExecutedWork work;
  double rate_gflop_s = 0.0;
  double peak_share = 0.0;
};

/// The phases on one problem and the machine's peak, measured in turns.
struct PhaseSpeeds {
  double peak_gflop_s = 0.0;
  PhaseSpeed linearise;
  PhaseSpeed sweep;  ///< what linearise_and_sweep() takes beyond linearise()
  PhaseSpeed evaluate;
  double textbook_sweep_share = 0.0;  ///< of the peak, counting textbook_sweep_flops() instead
};

/// Medians over that many rounds (a fraction of a millisecond each). `work`: of one run of each phase.
[[nodiscard]] PhaseSpeeds measure_phases(PlannerKernels& kernels, const IterationWork& work, int rounds);

}  // namespace stilt::benchmark
