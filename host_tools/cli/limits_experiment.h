#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_command.h"

namespace stilt::cli {

/// Adds the options that `experiment limits` has besides those of all experiments.
void add_limit_options(CLI::App& command, ExperimentOptions& options);

/// Seeks what the robot survives unannounced (host_tools/experiments/blind_limits.h), every quantity or those
/// that were chosen. `arguments` as for run_jobs(). Returns the exit status. Throws
/// UsageError or std::invalid_argument, one sentence, for bad input.
[[nodiscard]] int run_limits(const ExperimentOptions& options, const std::vector<std::string>& arguments);

}  // namespace stilt::cli
