#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_command.h"
#include "host_tools/experiments/commanded_speeds.h"

namespace stilt::cli {

/// Adds the options of `experiment speeds` that other experiments do not have.
void add_speed_options(CLI::App& command, ExperimentOptions& options);

/// The experiment of the options.
[[nodiscard]] experiments::SpeedPlan speed_plan(const ExperimentOptions& options);

/// Measures the mean speed of long walks (host_tools/experiments/commanded_speeds.h). `arguments` as for
/// run_jobs(). Returns the exit status. Throws UsageError or std::invalid_argument, one sentence, for bad
/// input.
[[nodiscard]] int run_speeds(const ExperimentOptions& options, const std::vector<std::string>& arguments);

}  // namespace stilt::cli
