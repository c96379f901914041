#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace stilt::commissioning {

inline constexpr int kOneLine = -1;

/// JSON as text that ends its line. Bytes that are not UTF-8, which an argument or the name of a file may
/// have, become U+FFFD.
/// @param indent  of each level; kOneLine: no other line
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent = 2);

}  // namespace stilt::commissioning
