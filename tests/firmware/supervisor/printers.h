#pragma once

#include <ostream>

#include "firmware/supervisor/fallback.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/state.h"

/// How GoogleTest prints the supervisor's values when a test fails.
namespace stilt::supervisor {

/// "{bus_off, lost_replies}".
inline void PrintTo(FaultSet faults, std::ostream* out) {
  const char* before = "{";
  for (const FaultRow& fault : kFaultTable) {
    if (!faults.has(fault.fault)) continue;
    *out << before << fault.name;
    before = ", ";
  }
  *out << (faults.empty() ? "{}" : "}");
}

inline void PrintTo(Fault fault, std::ostream* out) { *out << name(fault); }
inline void PrintTo(State state, std::ostream* out) { *out << name(state); }
inline void PrintTo(FallbackLevel level, std::ostream* out) { *out << name(level); }
inline void PrintTo(Reaction reaction, std::ostream* out) { *out << name(reaction); }

}  // namespace stilt::supervisor
