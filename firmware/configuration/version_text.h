#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace stilt::configuration {

/// 0x00060b of "0.6.11", and 0 of "none". Nothing: another text. Not real time.
[[nodiscard]] std::optional<std::uint32_t> parse_version(const std::string& text);

}  // namespace stilt::configuration
