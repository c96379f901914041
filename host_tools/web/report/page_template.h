#pragma once

#include <string_view>

namespace stilt::report {

/// The page as text, assembled from host_tools/web/report/page/ at build time. It contains each of the marks
/// `{{title}}` and `{{run_data}}` once; report.cc replaces them by the run.
extern const std::string_view kPageTemplate;

}  // namespace stilt::report
