#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_command.h"
#include "host_tools/experiments/joint_friction.h"

namespace stilt::cli {

/// Adds the options of `experiment friction` that other experiments do not have.
void add_friction_options(CLI::App& command, ExperimentOptions& options);

/// The experiment of the options.
[[nodiscard]] experiments::FrictionPlan friction_plan(const ExperimentOptions& options);

/// Measures the joint error that friction adds (host_tools/experiments/joint_friction.h). `arguments` as for
/// run_jobs(). Returns the exit status. Throws UsageError or std::invalid_argument, one sentence, for bad
/// input.
[[nodiscard]] int run_friction(const ExperimentOptions& options, const std::vector<std::string>& arguments);

}  // namespace stilt::cli
