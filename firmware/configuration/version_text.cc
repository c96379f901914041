#include "firmware/configuration/version_text.h"

#include <charconv>
#include <system_error>

namespace stilt::configuration {

std::optional<std::uint32_t> parse_version(const std::string& text) {
  if (text == "none") return 0;
  constexpr int kNumbers = 3;
  std::uint32_t version = 0;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int i = 0; i < kNumbers; ++i) {
    if (i > 0 && (at == end || *at++ != '.')) return std::nullopt;
    std::uint8_t number = 0;
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc()) return std::nullopt;
    version = version << 8 | number;
    at = next;
  }
  return at == end ? std::optional(version) : std::nullopt;
}

}  // namespace stilt::configuration
