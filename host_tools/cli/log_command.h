#pragma once

#include <CLI/App.hpp>
#include <string>

namespace stilt::cli {

/// Options of `stilt log csv`.
struct LogOptions {
  std::string file;
  std::string out;
};

/// Adds `log` with its subcommand `csv` to the program; stores its options in `options`.
CLI::App* add_log_command(CLI::App& program, LogOptions& options);

/// Writes a record as tables, and their names on standard output. Returns the exit status: 0, or 1 when
/// the record was cut off or damaged; the tables then contain everything that could be read. Throws
/// std::runtime_error, one sentence.
[[nodiscard]] int run_log(const LogOptions& options);

}  // namespace stilt::cli
