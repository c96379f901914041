#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace stilt::hal {

/// The emergency stop as an input of the program. The switch itself must also cut the power: this only
/// reports it.
enum class EmergencyStopState : std::uint8_t {
  released,  ///< reported so recently
  pressed,
  unknown,  ///< silent for too long, or never received: to be treated as pressed
  absent,   ///< this robot has no such input
};

[[nodiscard]] constexpr const char* name(EmergencyStopState state) noexcept {
  constexpr std::array<const char*, 4> kNames = {"released", "pressed", "silent", "not configured"};
  return kNames[static_cast<std::size_t>(state)];
}

}  // namespace stilt::hal
