#pragma once

#include <experimental/simd>

namespace stilt::model {

/// Several nodes of the horizon, one per lane of the widest register of the target.
using Batch = std::experimental::native_simd<double>;
inline constexpr int kLanes = static_cast<int>(Batch::size());

}  // namespace stilt::model
