#pragma once

#include <cstdint>

namespace stilt::gait {

enum class GaitKind : std::uint8_t { stand, step, walk };

/// What the operator asks for. Another kind of gait begins at a contact boundary; another speed within a walk
/// is approached at once, along the ramp.
struct GaitCommand {
  GaitKind kind = GaitKind::stand;
  double speed_m_s = 0.0;  ///< forward speed of the base; used by walk only
};

}  // namespace stilt::gait
