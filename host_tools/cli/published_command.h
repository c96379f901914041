#pragma once

#include <string>
#include <vector>

namespace stilt::cli {

/// The command line with which a reader gets the same figures: `stilt` and its arguments, with DIR for the
/// folder of --out and without what changes no figure (--json, --processes, --merge).
[[nodiscard]] std::string published_command(const std::vector<std::string>& arguments);

}  // namespace stilt::cli
