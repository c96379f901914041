#pragma once

#include <string>
#include <string_view>

namespace stilt::experiments {

/// 16 hexadecimal digits (FNV-1a, 64 bits) that differ for texts that differ, but for chance. No protection
/// against forgery.
[[nodiscard]] std::string text_hash(std::string_view text);

}  // namespace stilt::experiments
