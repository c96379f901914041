#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_walks.h"
#include "host_tools/experiments/shortest_horizon.h"

namespace stilt::cli {

/// Options of `stilt experiment` and its commands.
struct ExperimentOptions {
  WalkSetting setting;
  std::string command;  ///< command line that reproduces the results, stored with them
  std::string folder;   ///< of --out
  std::string json_file;
  bool quick = false;
  // Options of experiments that consist of jobs.
  bool list_jobs = false;
  bool merge = false;
  std::string job;             ///< of --job
  std::optional<int> at_once;  ///< of --processes
  std::vector<std::string> controllers;
  std::vector<double> horizons_s;
  std::optional<int> seeds;
  // Options of disturbance.
  std::string rows_file;  ///< of --rows
  std::string gait = "walk";
  double speed_m_s = 0.5;
  std::string direction = "forward";
  int phases = 8;
  double coarse_N = 10.0;
  // Options of limits.
  std::vector<std::string> quantities;  ///< of --quantity; empty: all, and random commands
  // Options of robustness.
  int runs = 500;
  std::uint32_t seed = 1;
  double force_N = 40.0;
  // Options of speeds.
  std::vector<double> speeds_m_s;  ///< of --speed; empty: those of the table
  // Options of friction.
  double friction_Nm = 5.0;
  // Options of paired, with the seed of robustness.
  int cases = 64;
  std::vector<std::string> pushes;  ///< of --push; empty: the usual ones
  // Options of frequency.
  int problems = 500;
};

/// Adds `experiment` with frequency, disturbance, horizon, speeds, limits, robustness, paired, friction and
/// figures; stores the options in `options`.
CLI::App* add_experiment_command(CLI::App& program, ExperimentOptions& options);

/// Adds the options of an experiment with one controller and one horizon.
void add_walk_options(CLI::App& command, ExperimentOptions& options);

/// The experiment of the options of horizon.
[[nodiscard]] experiments::HorizonPlan horizon_plan(const ExperimentOptions& options);

/// Runs the command that was given. `arguments` is the command line, for the processes of the jobs. Returns
/// the exit status. Throws UsageError or std::invalid_argument, one sentence, for bad input.
[[nodiscard]] int run_experiment(const CLI::App& experiment, ExperimentOptions options,
                                 const std::vector<std::string>& arguments);

}  // namespace stilt::cli
