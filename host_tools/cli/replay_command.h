#pragma once

#include <CLI/App.hpp>
#include <string>

namespace stilt::cli {

/// Options of `stilt replay`.
struct ReplayOptions {
  std::string file;
  std::string json_file;
  bool monitor = false;
  int port = 8080;
  bool no_browser = false;
};

/// Adds `replay` to the program; stores its options in `options`.
CLI::App* add_replay_command(CLI::App& program, ReplayOptions& options);

/// Runs every run of a record through the controller again, and prints whether all plans and torques are
/// equal. Returns the exit status: 0 when they are, 1 when something differs or is missing. Throws UsageError
/// or std::runtime_error, one sentence.
[[nodiscard]] int run_replay(const ReplayOptions& options);

}  // namespace stilt::cli
