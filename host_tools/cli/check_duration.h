#pragma once

#include <cmath>
#include <optional>

#include "host_tools/cli/usage_error.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::cli {

/// Throws UsageError unless --duration of a command that runs until stopped without it is above 0 s.
inline void check_duration(const std::optional<double>& duration_s) {
  if (!duration_s || (*duration_s > 0.0 && std::isfinite(*duration_s))) return;
  throw UsageError("--duration " + simulation::number_text(*duration_s) +
                   ": the duration must be above 0 s; leave it out to run until Ctrl-C");
}

}  // namespace stilt::cli
