#pragma once

#include <string>

#include "host_tools/recording/run_record.h"

namespace stilt::report {

/// A page shows at most this many samples; a longer run keeps every n-th, and the page says so.
inline constexpr std::size_t kMaxSamples = 24'000;
/// The planned motion is drawn from knots at least this far apart, the last one always kept.
inline constexpr double kPlanKnotSpacing_s = 0.04;
/// A page holds about this many knots over all plans; more plans than that are thinned evenly.
inline constexpr std::size_t kMaxPlanKnots = 48'000;

/// The run as the JSON text that the page reads (page/run_data.js is its reader): meta data and summary as
/// plain JSON, samples, plans and solves as packed columns. ASCII only; not yet escaped for HTML.
/// Non-finite numbers of the summary become null.
[[nodiscard]] std::string run_data_json(const log::RunRecord& record);

}  // namespace stilt::report
