#pragma once

#include <string>

namespace stilt::cli {

/// The value of -march the program was compiled for, the SIMD instructions that this means, and the lanes of
/// the planner's registers of doubles: "x86-64-v3, AVX2 with FMA, 4 lanes".
[[nodiscard]] std::string instruction_set();

/// What `stilt --version` prints: version, commit, compiler, instruction set, size of the controller's
/// object.
[[nodiscard]] std::string version_text();

}  // namespace stilt::cli
