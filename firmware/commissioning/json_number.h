#pragma once

#include <nlohmann/json.hpp>

namespace stilt::commissioning {

/// null for what is no number: JSON has none.
[[nodiscard]] nlohmann::ordered_json json_number(double value);

}  // namespace stilt::commissioning
