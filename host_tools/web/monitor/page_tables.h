#pragma once

#include <nlohmann/json.hpp>

namespace stilt::monitor {

/// {"ticks": [column names], "planner": ..., "plan": ..., "truth": ...}
[[nodiscard]] nlohmann::ordered_json all_column_names();

}  // namespace stilt::monitor
