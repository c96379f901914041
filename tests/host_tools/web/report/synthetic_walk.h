#pragma once

#include "host_tools/recording/run_record.h"

namespace stilt::report {

/// A kinematically plausible walk at 0.5 m/s with AMBER-3M's lengths, 200 samples and 100 plans per second,
/// and a push of 40 N from 5 s to 6 s. Forces, torques and errors are smooth made-up signals of the usual
/// size.
[[nodiscard]] log::RunRecord synthetic_walk(double duration_s);

}  // namespace stilt::report
