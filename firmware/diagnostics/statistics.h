#pragma once

#include "firmware/diagnostics/histogram.h"

namespace stilt::diagnostics {

/// Statistics of the torque loop; a copy goes to the housekeeping thread now and then.
struct LoopStatistics {
  Histogram wakeup_latency;
  Histogram execution;
  Histogram bus_round_trip;
  long long ticks = 0;
  long long late_ticks = 0;      ///< began later than supervisor.torque_loop_overrun_s
  long long missed_periods = 0;  ///< left out after an overrun
  long long heap_allocations = 0;
  long long page_faults = 0;
};

/// Statistics of the planner.
struct PlannerStatistics {
  Histogram solve;
  long long plans = 0;
  long long heap_allocations = 0;
  long long page_faults = 0;
};

}  // namespace stilt::diagnostics
