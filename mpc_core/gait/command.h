#pragma once

#include <cstdint>

namespace stilt::gait {

enum class GaitKind : std::uint8_t { stand, step, walk };

/// What the operator asks for; takes effect at the next contact boundary.
struct GaitCommand {
  GaitKind kind = GaitKind::stand;
  double speed_m_s = 0.0;  ///< forward speed of the base; used by walk only
};

}  // namespace stilt::gait
