#pragma once

#include "host_tools/recording/run_record.h"

namespace stilt::experiments {

/// Variation of a walk's joint angles from step to step.
struct Periodicity {
  int steps = 0;  ///< number compared
  /// Standard deviation of a joint's angle at the same share of the step, over the steps. First its root mean
  /// square over joints and shares, then the largest.
  double rms_rad = 0.0;
  double largest_rad = 0.0;
};

/// Compares the steps between measured touch-downs after `from_s`, with joints in the order of stance and
/// swing leg, at 50 shares of each step's duration. Needs samples; zeros with fewer than two steps.
[[nodiscard]] Periodicity periodicity(const log::RunRecord& record, double from_s);

}  // namespace stilt::experiments
