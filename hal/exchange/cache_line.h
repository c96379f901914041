#pragma once

#include <cstddef>

namespace stilt::exchange {

/// Data of different threads stand this far apart, so that one core's writes do not slow the other's reads.
/// A constant of ours: the compiler's own may differ between two of its flags.
inline constexpr std::size_t kCacheLine_bytes = 64;

}  // namespace stilt::exchange
