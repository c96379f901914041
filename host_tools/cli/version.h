#pragma once

#include <string>

namespace stilt::cli {

/// The output of `stilt --version`: version, commit, compiler, instruction set, size of the controller's
/// object.
[[nodiscard]] std::string version_text();

}  // namespace stilt::cli
