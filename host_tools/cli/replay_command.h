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

/// Adds `replay` to the program; its options end up in `options`.
CLI::App* add_replay_command(CLI::App& program, ReplayOptions& options);

/// Replays every run of a record through the controller and says whether all plans and torques came
/// out the same. Returns the exit status: 0 they did, 1 something differs or is missing. Throws UsageError or
/// std::runtime_error, one sentence.
[[nodiscard]] int run_replay(const ReplayOptions& options);

}  // namespace stilt::cli
