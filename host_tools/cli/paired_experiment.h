#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_command.h"
#include "host_tools/experiments/paired.h"

namespace stilt::cli {

/// Adds the options of `experiment paired` that other experiments do not have.
void add_paired_options(CLI::App& command, ExperimentOptions& options);

/// The experiment of the options: plans 100, 200 and 500 times per second, the true state, feedback gains.
[[nodiscard]] experiments::PairedPlan paired_plan(const ExperimentOptions& options);

/// Walks the same pushes under each variant (host_tools/experiments/paired.h). `arguments` as for run_jobs().
/// Returns the exit status. Throws UsageError or std::invalid_argument, one sentence, for bad input.
[[nodiscard]] int run_paired(const ExperimentOptions& options, const std::vector<std::string>& arguments);

}  // namespace stilt::cli
