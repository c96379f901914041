#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_command.h"
#include "host_tools/experiments/blind_limits.h"

namespace stilt::cli {

/// Adds the options of `experiment limits` that other experiments do not have.
void add_limit_options(CLI::App& command, ExperimentOptions& options);

/// The experiment of the options. Throws UsageError for an unknown quantity.
[[nodiscard]] experiments::LimitPlan limit_plan(const ExperimentOptions& options);

/// Searches the limits that the robot survives unannounced (host_tools/experiments/blind_limits.h), of all
/// quantities or of those chosen. `arguments` as for run_jobs(). Returns the exit status. Throws UsageError
/// or std::invalid_argument, one sentence, for bad input.
[[nodiscard]] int run_limits(const ExperimentOptions& options, const std::vector<std::string>& arguments);

}  // namespace stilt::cli
