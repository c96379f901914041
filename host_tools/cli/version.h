#pragma once

#include <string>

namespace stilt::cli {

/// The value of -march of this build, the resulting SIMD instructions, and the lanes of the planner's
/// registers of doubles: "x86-64-v3, AVX2 with FMA, 4 lanes".
[[nodiscard]] std::string instruction_set();

/// The output of `stilt --version`: version, commit, compiler, instruction set, size of the controller's
/// object.
[[nodiscard]] std::string version_text();

}  // namespace stilt::cli
