#pragma once

#include <cstdint>
#include <string_view>

namespace stilt::model {

/// SIMD instructions that the planner may be compiled for.
enum class InstructionSet : std::uint8_t {
  automatic,  ///< what plans most often on this processor
  sse2,
  avx2,  ///< with FMA
  avx512,
  neon,
};

/// Names in the order of the enumerators, as in the configuration.
inline constexpr std::string_view kInstructionSetNames[] = {"auto", "sse2", "avx2", "avx512", "neon"};

[[nodiscard]] constexpr std::string_view name_of(InstructionSet set) noexcept {
  return kInstructionSetNames[static_cast<int>(set)];
}

}  // namespace stilt::model
