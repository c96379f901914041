#pragma once

#include <CLI/App.hpp>
#include <string>

#include "firmware/telemetry/participant.h"

namespace stilt::cli {

/// Options of `stilt record`.
struct RecordOptions {
  std::string out_file;
  double duration_s = 0.0;  ///< 0: until stopped
  std::string compression = "zstd";
  telemetry::Network network;
  std::string json_file;
};

/// Adds `record` to the program; its options end up in `options`.
CLI::App* add_record_command(CLI::App& program, RecordOptions& options);

/// Records until the duration is over or SIGINT or SIGTERM comes, and says what was recorded. Returns the
/// exit status: 0, or 1 when nothing was received or ticks are missing. Throws UsageError or
/// std::runtime_error, one sentence.
[[nodiscard]] int run_record(const RecordOptions& options);

}  // namespace stilt::cli
