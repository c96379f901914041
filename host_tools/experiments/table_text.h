#pragma once

#include <optional>
#include <string>

#include "host_tools/experiments/correlation.h"
#include "host_tools/experiments/job_folder.h"

/// Pieces of the experiments' tables.
namespace stilt::experiments {

/// A number in a printf format for one double.
[[nodiscard]] std::string text(const char* format, double value);

/// The same for a value that may be null.
[[nodiscard]] std::string cell(const Json& value, const char* format, const char* absent = "-");

/// {value, low, high}, or null without an estimate.
[[nodiscard]] Json to_json(const std::optional<Estimate>& estimate);

/// An estimate with its interval, "0.20 (0.10 to 0.30)", from {value, low, high}.
/// @param format  of each of the three, as in text()
[[nodiscard]] std::string estimate_text(const Json& estimate, const char* format);

}  // namespace stilt::experiments
