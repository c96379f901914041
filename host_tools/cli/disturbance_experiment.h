#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_command.h"
#include "host_tools/experiments/disturbance.h"

namespace stilt::cli {

/// Adds the options of `experiment disturbance` that other experiments do not have.
void add_disturbance_options(CLI::App& command, ExperimentOptions& options);

/// The experiment of the options: the published rows that they select, or those of --rows. Throws UsageError
/// or std::invalid_argument, one sentence.
[[nodiscard]] experiments::DisturbancePlan disturbance_plan(const ExperimentOptions& options);

/// Measures the largest pushes survived: runs the jobs and writes table and figures. Returns the exit status.
/// Throws UsageError or std::invalid_argument, one sentence, for bad input.
[[nodiscard]] int run_disturbance(const ExperimentOptions& options,
                                  const std::vector<std::string>& arguments);

}  // namespace stilt::cli
