#pragma once

#include <cstdint>

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

  /// Counts a tick, as late above the limit. Real-time.
  void add_tick(std::int64_t wakeup_latency_ns, std::int64_t execution_ns, std::int64_t overrun_ns) noexcept {
    wakeup_latency.add_ns(wakeup_latency_ns);
    execution.add_ns(execution_ns);
    ++ticks;
    if (wakeup_latency_ns > overrun_ns) ++late_ticks;
  }
};

/// Statistics of the planner.
struct PlannerStatistics {
  Histogram solve;
  long long plans = 0;
  long long heap_allocations = 0;
  long long page_faults = 0;
};

}  // namespace stilt::diagnostics
