#pragma once

#include <string>

#include "host_tools/recording/run_record.h"

namespace stilt::report {

/// Largest number of samples on a page. Of a longer run every n-th sample is kept, and the page shows n.
inline constexpr std::size_t kMaxSamples = 24'000;
/// Least distance of the nodes from which the planned motion is drawn; the last node is always kept.
inline constexpr double kPlanNodeSpacing_s = 0.04;
/// Approximate number of nodes of all plans on a page. Further plans are thinned evenly.
inline constexpr std::size_t kMaxPlanNodes = 48'000;

/// The run as the JSON text that page/run_data.js reads: meta data and summary as plain JSON; samples, plans
/// and solves as packed columns. ASCII only; not yet escaped for HTML. Non-finite numbers of the summary
/// become null.
[[nodiscard]] std::string run_data_json(const log::RunRecord& record);

}  // namespace stilt::report
