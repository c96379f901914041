#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/cli/controller_choice.h"

namespace stilt::cli {

/// Options of `stilt sim`.
struct SimOptions {
  ControllerChoice choice;
  std::string gait = "walk";
  double speed_m_s = 0.5;
  double duration_s = 10.0;
  std::vector<std::string> pushes;
  std::vector<std::string> later_commands;  ///< of --then
  std::string state = "estimated";
  std::optional<double> planner_until_s;
  std::vector<std::string> faults;
  std::uint32_t seed = 1;
  std::vector<std::string> plant_settings;
  std::string json_file, report_file, log_file;
};

/// Adds `sim` to the program; stores its options in `options`.
CLI::App* add_sim_command(CLI::App& program, SimOptions& options);

/// Runs the simulated robot and writes the requested files. Returns the exit status: 0, or 1 when the robot
/// fell. Throws UsageError or std::invalid_argument, one sentence, for bad input.
[[nodiscard]] int run_sim(const SimOptions& options, const std::string& command_line);

}  // namespace stilt::cli
