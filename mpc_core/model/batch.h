#pragma once

#include <experimental/simd>

namespace stilt::model {

/// Several nodes of the horizon, one a lane: as many as the widest register of the target holds.
using Batch = std::experimental::native_simd<double>;
inline constexpr int kLanes = static_cast<int>(Batch::size());

}  // namespace stilt::model
