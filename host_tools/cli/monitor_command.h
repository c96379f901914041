#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "firmware/telemetry/participant.h"

namespace stilt::cli {

/// Options of `stilt monitor`.
struct MonitorOptions {
  telemetry::Network network;
  std::string address = "127.0.0.1";
  int port = 8080;
  std::vector<std::string> names;  ///< further host names under which the page is opened
  std::string token_file;
  std::string viewers = "any";  ///< web sites of Foxglove viewers: any, none, or origins separated by commas
  bool terminal = false;
  bool no_browser = false;
};

/// Adds `monitor` to the program; stores its options in `options`.
CLI::App* add_monitor_command(CLI::App& program, MonitorOptions& options);

/// Serves the page, or shows a summary on the terminal, until it is stopped. Returns the exit status. Throws
/// UsageError or std::runtime_error, one sentence.
[[nodiscard]] int run_monitor(const MonitorOptions& options);

}  // namespace stilt::cli
