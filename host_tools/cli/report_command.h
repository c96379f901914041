#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

namespace stilt::cli {

/// Options of `stilt report`.
struct ReportOptions {
  std::vector<std::string> files;
  std::string out;    ///< empty: a new file beside the first one
  std::string robot;  ///< empty: amber3m, where a file does not name its robot
  std::optional<double> shift_s;
};

/// Adds `report` to the program; stores its options in `options`.
CLI::App* add_report_command(CLI::App& program, ReportOptions& options);

/// Makes the page of a run's file, or one of two files. Returns the exit status: 0 done, 1 a file lacks
/// ticks, was cut off or is damaged (the rest is shown). Throws UsageError or std::runtime_error, one
/// sentence.
[[nodiscard]] int run_report(const ReportOptions& options);

}  // namespace stilt::cli
