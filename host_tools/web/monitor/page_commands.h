#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>

#include "host_tools/web/monitor/sample_source.h"

// clang-format off
/// Messages of the page:
///   {"alive": true}   several times per second
///   {"alive": true, "link_time_s": 71.3}   with `time_s` of the newest `link` message that the page has. When that
///                     is older than kCatchUp_s the page gets no tables, older than kOldestLink_s no heartbeat.
///   {"command": "walk", "sequence": 3, "value": 0.5, "tunable": "", "token": "", "tokens": {}}
///                     only the first two members are required; `tokens` are those of other runs, for stop
///   {..., "link_time_s": 71.3}   of a command: `time_s` of the newest `link` message that the page has. When that
///                     is older than kOldestLink_s the command is refused, but for stop and cut. Without this
///                     member the age is not known, and nothing is refused for it.
///   {"key": "..."}    the monitor's key, first of all when the page has it
///   {"new_key": true} the key ends, another one begins
///   {"from": 12.5}    plays a record from that time of Playback, s
///   {"hold": true}    holds a record where it is; false: lets it go on
///   {"run": "001085a41154fb89"}   shows another run
// clang-format on
namespace stilt::monitor {

/// A message of the page.
struct PageMessage {
  bool is_command = false;            ///< false: a sign of life
  std::optional<double> from_s;       ///< a record is played from there; finite
  std::optional<bool> hold;           ///< of a record; none: no change
  std::string run;                    ///< run to show from now on; empty: no change
  std::string key;                    ///< of the monitor; empty: none is given
  bool new_key = false;               ///< whether the monitor's key is replaced
  Command command;                    ///< `commander` is set by the caller
  std::optional<double> link_time_s;  ///< of the newest link message that the page had when it sent this
};

/// Parses a message; the error is one sentence.
[[nodiscard]] std::expected<PageMessage, std::string> parse_page_message(std::string_view text);

}  // namespace stilt::monitor
