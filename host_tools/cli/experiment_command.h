#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_walks.h"

namespace stilt::cli {

/// Options of `stilt experiment` and its commands.
struct ExperimentOptions {
  WalkSetting setting;
  std::string command;  ///< that gives the figures again, kept with them
  std::string folder;   ///< of --out
  std::string json_file;
  bool quick = false;
  // Experiments that are made of jobs.
  bool list_jobs = false;
  bool merge = false;
  std::string job;             ///< of --job
  std::optional<int> at_once;  ///< of --processes
  std::vector<std::string> controllers;
  std::vector<double> horizons_s;
  std::optional<int> seeds;
  // The disturbance.
  std::string rows_file;  ///< of --rows
  std::string gait = "walk";
  double speed_m_s = 0.5;
  std::string direction = "forward";
  int phases = 8;
  double coarse_N = 10.0;
  // The blind limits.
  std::vector<std::string> quantities;  ///< of --quantity; empty: all, and random commands
  // The frequency.
  int problems = 500;
};

/// Adds `experiment` with frequency, disturbance, horizon, limits and figures; options end up in `options`.
CLI::App* add_experiment_command(CLI::App& program, ExperimentOptions& options);

/// Runs the command that was given. `arguments` is the command line, for the processes that jobs run in.
/// Returns the exit status. Throws UsageError or std::invalid_argument, one sentence, for bad input.
[[nodiscard]] int run_experiment(const CLI::App& experiment, ExperimentOptions options,
                                 const std::vector<std::string>& arguments);

}  // namespace stilt::cli
