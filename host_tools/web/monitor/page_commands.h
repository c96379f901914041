#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "host_tools/web/monitor/sample_source.h"

/// What the page sends: {"alive": true} several times per second, and
/// {"command": "walk", "sequence": 3, "value": 0.5, "tunable": "", "token": ""}, where only the first two
/// must be there; and {"again": true}, which a record applies.
namespace stilt::monitor {

/// A message of the page.
struct PageMessage {
  bool is_command = false;  ///< false: a sign of life
  bool again = false;       ///< a record shall play from its start
  Command command;          ///< `commander` is left to the caller
};

/// Reads one; the error is a sentence.
[[nodiscard]] std::expected<PageMessage, std::string> parse_page_message(std::string_view text);

/// "walk".
[[nodiscard]] const char* name(CommandKind kind);

}  // namespace stilt::monitor
