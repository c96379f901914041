#pragma once

#include <filesystem>
#include <string>

#include "host_tools/recording/run_record.h"

/// One run as one HTML page that needs no network: animation, time plots, summary.
namespace stilt::report {

/// The page as text. All content of `record` is escaped. Non-finite values become gaps in the plots.
[[nodiscard]] std::string render_report(const log::RunRecord& record);

/// Writes render_report(record) to `file`, replacing it.
/// \throws std::runtime_error one sentence naming the file when it cannot be written.
void write_report(const log::RunRecord& record, const std::filesystem::path& file);

}  // namespace stilt::report
