#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/telemetry/participant.h"

namespace stilt::cli {

/// Options of `stilt robot`.
struct RobotOptions {
  std::string robot;                  ///< empty: that of the configuration
  std::string config_file;            ///< empty: the file shipped for the robot
  std::string preset;                 ///< of --preset; empty: none
  std::vector<std::string> settings;  ///< of --set
  std::vector<std::string> buses;     ///< of --bus; empty: buses of the configuration
  bool lockstep = false;
  bool once = false;
  std::optional<double> duration_s;
  std::vector<std::string> faults;
  std::vector<std::string> pushes;
  bool hang = false;
  std::string hands_file;             ///< of --hands; "-": standard input; empty: none
  std::vector<std::string> miswired;  ///< of --miswired
  std::vector<std::string> plant_settings;
  bool publish = false;
  telemetry::Network network;
  std::uint32_t seed = 1;
  std::string json_file, report_file, log_file, frames_file;
};

/// Adds `robot` to the program; stores its options in `options`.
CLI::App* add_robot_command(CLI::App& program, RobotOptions& options);

/// Simulates the robot behind its motor drivers until the run is over, and writes the requested files.
/// Returns the exit status: 0 when the robot walked or stood on its own to the end, 1 when it fell or never
/// left the gantry. Throws UsageError, std::invalid_argument or std::runtime_error, one sentence.
[[nodiscard]] int run_robot(const RobotOptions& options, const std::string& command_line);

}  // namespace stilt::cli
