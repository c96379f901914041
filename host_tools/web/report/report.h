#pragma once

#include <string>

#include "host_tools/recording/run_record.h"

/// One run as one HTML page that needs no network: animation, time plots, summary.
namespace stilt::report {

/// The page as text. All content of `record` is escaped. Non-finite values become gaps in the plots.
[[nodiscard]] std::string render_report(const log::RunRecord& record);

}  // namespace stilt::report
