#pragma once

#include "firmware/diagnostics/statistics.h"

namespace stilt::telemetry::testing {

/// Statistics of both threads, another number in each field.
[[nodiscard]] inline diagnostics::LoopStatistics numbered_loop_statistics() {
  diagnostics::LoopStatistics loop;
  loop.ticks = 101;
  loop.late_ticks = 7;
  loop.missed_periods = 11;
  loop.heap_allocations = 2;
  loop.page_faults = 3;
  loop.wakeup_latency.add_ns(1'000'000);
  loop.execution.add_ns(2'000'000);
  loop.bus_round_trip.add_ns(3'000'000);
  return loop;
}

[[nodiscard]] inline diagnostics::PlannerStatistics numbered_planner_statistics() {
  diagnostics::PlannerStatistics planning;
  planning.plans = 13;
  planning.heap_allocations = 30;
  planning.page_faults = 50;
  planning.solve.add_ns(4'000'000);
  return planning;
}

}  // namespace stilt::telemetry::testing
