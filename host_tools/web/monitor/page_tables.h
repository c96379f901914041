#pragma once

#include <nlohmann/json.hpp>

namespace stilt::monitor {

/// The names of all columns: {"ticks": [column names], "planner": ..., "plan": ..., "truth": ...}.
[[nodiscard]] nlohmann::ordered_json all_column_names();

}  // namespace stilt::monitor
