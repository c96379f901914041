#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace stilt::cli {

/// Options of `stilt gait` and its commands.
struct GaitOptions {
  std::string robot = "amber3m";
  double speed_m_s = 0.5;
  double step_time_s = 0.3;
  std::string cost = "torque";
  std::string phase = "auto";
  int output_degree = 6;
  std::vector<std::string> limits;  ///< of --limit, KEY=VALUE
  double from_m_s = -0.4;
  double to_m_s = 1.0;
  double step_m_s = 0.1;
  std::string file;  ///< input of check, complete and show
  std::string out;   ///< output file, or folder of library
  std::string json_file;
  std::string report_file;
};

/// Adds `gait` with synthesize, check, complete, library and show; stores the options in `options`.
CLI::App* add_gait_command(CLI::App& program, GaitOptions& options);

/// Runs the command that was given. Returns the exit status: 0, or 1 when no gait was found or a check
/// failed. Throws UsageError, one sentence, for bad input.
[[nodiscard]] int run_gait(const CLI::App& gait, GaitOptions options);

}  // namespace stilt::cli
