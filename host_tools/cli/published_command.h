#pragma once

#include <string>
#include <vector>

namespace stilt::cli {

/// The command line with which a reader reproduces the results: `stilt` and its arguments, with DIR for the
/// folder of --out. Options that change no figure are left out (--json, --processes, --merge).
[[nodiscard]] std::string published_command(const std::vector<std::string>& arguments);

}  // namespace stilt::cli
