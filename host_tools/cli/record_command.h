#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>

#include "firmware/telemetry/participant.h"

namespace stilt::cli {

/// Options of `stilt record`.
struct RecordOptions {
  std::string out_file;
  std::optional<double> duration_s;  ///< none: until stopped
  std::string compression = "zstd";
  telemetry::Network network;
  std::string json_file;
};

/// Adds `record` to the program; stores its options in `options`.
CLI::App* add_record_command(CLI::App& program, RecordOptions& options);

/// Records until the duration is over or SIGINT or SIGTERM arrives, and prints what was recorded. Returns the
/// exit status: 0, or 1 when no sample was received or ticks are missing. Throws UsageError or
/// std::runtime_error, one sentence.
[[nodiscard]] int run_record(const RecordOptions& options);

}  // namespace stilt::cli
