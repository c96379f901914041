#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "host_tools/log/run_record.h"

namespace stilt::cli {

/// {p50, p99, max}.
[[nodiscard]] nlohmann::ordered_json to_json(const log::Percentiles& percentiles);

/// What `stilt sim --json` writes: the fields of docs/interfaces.
[[nodiscard]] nlohmann::ordered_json to_json(const log::RunSummary& summary);

/// Writes indented JSON to a file, or to standard output when the path is "-". Throws UsageError when the
/// file cannot be written.
void write_json(const nlohmann::ordered_json& json, const std::string& path);

}  // namespace stilt::cli
