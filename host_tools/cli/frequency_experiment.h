#pragma once

#include "host_tools/cli/experiment_command.h"

namespace stilt::cli {

/// The first table of the paper. It has the planning rate at horizons of 2.0, 1.0, 0.5 and 0.2 s, with all
/// ten iterations and with early stop. One thread solves the problems of a walk at 0.5 m/s. Writes
/// frequency.json and table.md into the folder of --out. Returns the exit status: 0, or 1 when a plan failed.
[[nodiscard]] int run_frequency(const ExperimentOptions& options);

}  // namespace stilt::cli
