#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace stilt::host_telemetry {

/// Checks the wire version of messages (firmware/telemetry/wire_version.h). Returns nothing when this program
/// reads it, otherwise the end of a sentence whose subject is a record or a run of stiltd.
/// @param version  nothing: the messages have none, as those of release 0.1
[[nodiscard]] std::optional<std::string> wire_version_problem(std::optional<std::uint32_t> version);

}  // namespace stilt::host_telemetry
