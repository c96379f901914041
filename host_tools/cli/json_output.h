#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "host_tools/recording/run_record.h"

namespace stilt::cli {

/// {p50, p99, max}.
[[nodiscard]] nlohmann::ordered_json to_json(const log::Percentiles& percentiles);

/// The part of it that the plant alone knows: how far, how fast, with what torque, and whether it fell.
[[nodiscard]] nlohmann::ordered_json plant_json(const log::RunSummary& summary);

/// What `stilt sim --json` writes: the fields of docs/interfaces.
[[nodiscard]] nlohmann::ordered_json to_json(const log::RunSummary& summary);

/// Throws UsageError unless a file of that name could be written: its folder exists and is writable, and it
/// is no folder itself. Empty names and "-" pass. For commands that compute for long before they write.
void check_output_file(const std::string& option, const std::string& path);

/// Writes indented JSON to a file, or to standard output when the path is "-". Throws UsageError when the
/// file cannot be written.
void write_json(const nlohmann::ordered_json& json, const std::string& path);

}  // namespace stilt::cli
