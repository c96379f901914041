#pragma once

#include <string>
#include <vector>

#include "host_tools/recording/mcap/reader.h"

namespace stilt::record {

/// Refuses a message with the configuration of a run whose messages have another wire version than this
/// program reads. Accepts every other message. Throws std::runtime_error, one sentence that begins with the
/// path.
void require_wire_version(const std::string& path, const mcap::ReadMessage& read);

/// Refuses a record by its first configuration, as above. Accepts a record without one. Throws
/// std::runtime_error, one sentence, also when the file is not a record.
void require_wire_version(const std::string& path);

/// The same for what stilt record writes beside the configuration of a run, metadata named "stiltd".
void require_wire_version(const std::string& path, const mcap::Metadata& of_run);

/// Why a record has no configuration of a run: what its reader found first, or that it began too late.
/// @param problems  of the reader; each begins with the path
[[nodiscard]] std::string without_configuration(const std::string& path,
                                                const std::vector<std::string>& problems);

/// Why a record without ticks is no use, one sentence that begins with the path.
/// @param problems  of the reader; each begins with the path
[[nodiscard]] std::string without_ticks(const std::string& path, const std::vector<std::string>& problems);

}  // namespace stilt::record
