#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "host_tools/web/monitor/sample_source.h"

/// Messages of the page: {"alive": true} several times per second, and {"command": "walk", "sequence": 3,
/// "value": 0.5, "tunable": "", "token": ""}, where only the first two members are required; and {"again":
/// true}, which restarts a record; and {"run": "001085a41154fb89"}, which shows another run.
namespace stilt::monitor {

/// A message of the page.
struct PageMessage {
  bool is_command = false;  ///< false: a sign of life
  bool again = false;       ///< whether a record starts again
  std::string run;          ///< run to show from now on; empty: no change
  Command command;          ///< `commander` is set by the caller
};

/// Parses a message; the error is one sentence.
[[nodiscard]] std::expected<PageMessage, std::string> parse_page_message(std::string_view text);

/// Name of a command: "walk".
[[nodiscard]] const char* name(CommandKind kind);

}  // namespace stilt::monitor
