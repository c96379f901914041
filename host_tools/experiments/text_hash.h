#pragma once

#include <string>
#include <string_view>

namespace stilt::experiments {

/// Hash of a text as 16 hexadecimal digits (FNV-1a, 64 bits). No protection against forgery.
[[nodiscard]] std::string text_hash(std::string_view text);

}  // namespace stilt::experiments
