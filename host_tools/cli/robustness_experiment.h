#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_command.h"
#include "host_tools/experiments/robustness.h"

namespace stilt::cli {

/// Adds the options of `experiment robustness` that other experiments do not have.
void add_robustness_options(CLI::App& command, ExperimentOptions& options);

/// The experiment of the options.
[[nodiscard]] experiments::RobustnessPlan robustness_plan(const ExperimentOptions& options);

/// Walks random robots in random worlds (host_tools/experiments/robustness.h) and writes robustness.html, the
/// pages of the worst runs and commands.txt to the folder. `arguments` as for run_jobs(). Returns the exit
/// status. Throws UsageError or std::invalid_argument, one sentence, for bad input.
[[nodiscard]] int run_robustness(const ExperimentOptions& options, const std::vector<std::string>& arguments);

}  // namespace stilt::cli
