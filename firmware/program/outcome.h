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

inline constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

/// A fault as the report lists it: once until the operator resets the faults, with how often its cause came.
struct ReportedFault {
  std::string name;
  double time_s = 0.0;  ///< of the first time; NaN: its event was lost
  std::string reaction;
  long long count = 1;
  double over_s = kNotKnown;      ///< when its cause was last gone
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
  std::uint64_t dropped_events = 0;     ///< states and faults that were not reported: no room was left
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

/// What the torque loop was like in its last tick.
struct LastTick {
  double time_s = 0.0;
  supervisor::State state = supervisor::State::boot;
  supervisor::State last_state = supervisor::State::boot;  ///< the newest that was not off
  supervisor::FaultSet latched;
};

/// After take_events(), once the torque loop has ended: states and latched faults are its own, whatever the
/// ring of events has lost.
/// @param dropped  events without room in the ring
void take_end(const LastTick& last, std::uint64_t dropped, Outcome& outcome);

/// Now, by the clock of the computer: "2026-11-27T13:15:00Z".
[[nodiscard]] std::string utc_now();

/// The results as JSON text.
[[nodiscard]] std::string to_json(const Outcome& outcome);

}  // namespace stilt::program
