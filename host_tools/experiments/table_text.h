#pragma once

#include <string>

#include "host_tools/experiments/job_folder.h"

/// Pieces of the experiments' tables.
namespace stilt::experiments {

/// A number in a printf format for one double.
[[nodiscard]] std::string text(const char* format, double value);

/// The same for a value that may be null.
[[nodiscard]] std::string cell(const Json& value, const char* format, const char* absent = "-");

}  // namespace stilt::experiments
