#pragma once

#include <string_view>

namespace stilt::monitor {

/// The page as text, assembled from host_tools/web/monitor/page/ at build time.
extern const std::string_view kMonitorPage;

}  // namespace stilt::monitor
