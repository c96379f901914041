#pragma once

#include <cstdint>

namespace stilt::hal {

/// The emergency stop as an input of the program. The switch itself must also cut the power: this only
/// reports it.
enum class EmergencyStopState : std::uint8_t {
  released,  ///< said so recently
  pressed,
  unknown,  ///< silent for too long, or never received: to be treated as pressed
  absent,   ///< this robot has no such input
};

}  // namespace stilt::hal
