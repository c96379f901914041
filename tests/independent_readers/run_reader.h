#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace stilt::independent_readers {

/// Runs a script of this folder with node and gives the JSON it prints. Throws std::runtime_error with what
/// it printed when it fails.
[[nodiscard]] nlohmann::json run_reader(const std::string& script, const std::vector<std::string>& arguments);

}  // namespace stilt::independent_readers
