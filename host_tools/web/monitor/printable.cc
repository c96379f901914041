#include "host_tools/web/monitor/printable.h"

#include <algorithm>
#include <cstddef>

namespace stilt::monitor {
namespace {

unsigned byte_of(std::string_view text, std::size_t index) { return static_cast<unsigned char>(text[index]); }

/// Bytes that a UTF-8 character with this first byte has; 0: none begins with it.
std::size_t length_from(unsigned first) {
  if (first < 0x80) return 1;
  if (first < 0xc2 || first > 0xf4) return 0;
  if (first < 0xe0) return 2;
  return first < 0xf0 ? 3 : 4;
}

/// Bytes of the UTF-8 character at the start of the text, in its shortest form; 0: there is none.
std::size_t character_bytes(std::string_view text) {
  const unsigned first = byte_of(text, 0);
  const std::size_t length = length_from(first);
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte_of(text, i) & 0xc0U) != 0x80) return 0;
  }
  const bool too_long =
      (first == 0xe0 && byte_of(text, 1) < 0xa0) || (first == 0xf0 && byte_of(text, 1) < 0x90);
  return too_long ? 0 : length;
}

/// Whether a character of that many bytes is of C0 or C1, or delete.
bool is_control(std::string_view text, std::size_t bytes) {
  const unsigned first = byte_of(text, 0);
  if (bytes == 1) return first < 0x20 || first == 0x7f;
  return first == 0xc2 && byte_of(text, 1) < 0xa0;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t bytes = character_bytes(text);
    if (bytes == 0 || is_control(text, bytes)) {
      result += '?';
    } else {
      result += text.substr(0, bytes);
    }
    text.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  return result;
}

}  // namespace stilt::monitor
