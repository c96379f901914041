#pragma once

#include <string_view>

namespace stilt::report {

/// The whole page as text, assembled from host_tools/web/report/page/ when the project is built. It holds
/// each of the marks `{{title}}` and `{{run_data}}` once; report.cc puts the run in their place.
extern const std::string_view kPageTemplate;

}  // namespace stilt::report
