#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "firmware/control_loop/events.h"
#include "firmware/diagnostics/histogram.h"

namespace stilt::telemetry {
class TelemetryNode;
}

namespace stilt::program {

inline constexpr double kNotOver = std::numeric_limits<double>::quiet_NaN();

/// A fault as the report lists it: once until the operator resets the faults, with how often its cause came.
struct ReportedFault {
  std::string name;
  double time_s = 0.0;  ///< of the first time
  std::string reaction;
  long long count = 1;
  double over_s = kNotOver;       ///< when its cause was last gone
  supervisor::FaultDetail found;  ///< by the first
};

/// What a run of the controller was like.
struct Outcome {
  std::string started;       ///< by the clock of the computer, ISO 8601 in UTC
  std::string commit;        ///< that stiltd was built from
  std::uint64_t run_id = 0;  ///< as in records; 0: without telemetry there is none
  std::string state;         ///< the supervisor's at the end
  std::string last_state;    ///< the one before it was off
  std::vector<ReportedFault> faults;
  std::size_t faults_before_reset = 0;  ///< the first of them are done with
  long long ticks = 0;
  long long late_ticks = 0;
  long long missed_periods = 0;
  long long plans = 0;
  diagnostics::Percentiles wakeup_latency_us;
  diagnostics::Percentiles execution_us;
  diagnostics::Percentiles bus_round_trip_us;
  diagnostics::Percentiles solve_us;
  long long heap_allocations = 0;
  long long page_faults = 0;
  std::string idle_states = "as they are";  ///< of the processors while it ran
  std::string not_realtime;                 ///< why the machine cannot keep time; empty: it can
  std::string
      waits;  ///< why the robot does not stand up or its drivers do not come up; empty: nothing was said
  std::string error;        ///< what ended the run from outside; empty: nothing
  std::string not_written;  ///< about the file of --black-box; empty: it is complete, or was not needed
};

/// Takes what happened out of the ring: reports it on standard error and to telemetry, if any, and keeps the
/// faults.
void take_events(control_loop::EventRing& events, Outcome& outcome,
                 telemetry::TelemetryNode* telemetry_node = nullptr);

/// Now, by the clock of the computer: "2026-11-27T13:15:00Z".
[[nodiscard]] std::string utc_now();

/// The results as JSON text.
[[nodiscard]] std::string to_json(const Outcome& outcome);

}  // namespace stilt::program
