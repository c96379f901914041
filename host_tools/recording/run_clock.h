#pragma once

#include "host_tools/recording/run_record.h"

namespace stilt::log {

/// Moves a run to another clock. Adds `start_s`, the time on it at which the run starts, to every time of
/// samples, plans, solves, steps and the fall. Durations stay.
void count_from(RunRecord& record, double start_s);

}  // namespace stilt::log
