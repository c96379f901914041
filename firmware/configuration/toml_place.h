#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <string_view>

namespace stilt::configuration {

/// Byte of a place in a text; TOML counts columns in characters, which are one to four bytes of UTF-8.
[[nodiscard]] inline std::size_t offset_of(std::string_view text, toml::source_position place) {
  std::size_t offset = 0;
  for (toml::source_index line = 1; line < place.line; ++line) offset = text.find('\n', offset) + 1;
  const auto continues = [&] { return offset < text.size() && (text[offset] & 0xc0) == 0x80; };
  for (toml::source_index column = 1; column < place.column; ++column) {
    ++offset;
    while (continues()) ++offset;
  }
  return offset;
}

}  // namespace stilt::configuration
