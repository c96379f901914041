#pragma once

#include <cstdint>

namespace stilt::gait {

enum class GaitKind : std::uint8_t { stand, step, walk };

/// Direction in which a standing robot falls.
enum class Fall : std::uint8_t { none, forward, backward };

/// The operator's command. A change of the kind of gait becomes active at a contact boundary. A change of
/// speed within a walk starts at once and follows the ramp.
struct GaitCommand {
  GaitKind kind = GaitKind::stand;
  double speed_m_s = 0.0;  ///< forward speed of the base; used by walk only
};

/// The present step of a gait that the joints track without a plan.
struct TrackedStep {
  int stance_foot = -1;       ///< model::kLeft or model::kRight; -1: no gait is tracked
  double touch_down_s = 0.0;  ///< of that foot
  double duration_s = 0.0;    ///< of a step of the gait
};

}  // namespace stilt::gait
