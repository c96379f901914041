#pragma once

#include <string>
#include <string_view>

namespace stilt::monitor {

/// The text with ? in place of what could command a terminal: control characters and bytes that are no UTF-8.
/// Line feed, delete and C1 are among them. For a line of text from the network.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace stilt::monitor
