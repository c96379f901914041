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
inline constexpr std::size_t kEmergencyStopStates = 4;

/// A number that is none of them is "unknown".
[[nodiscard]] constexpr const char* name(EmergencyStopState state) noexcept {
  constexpr std::array<const char*, kEmergencyStopStates> kNames = {"released", "pressed", "silent",
                                                                    "not configured"};
  const auto number = static_cast<std::size_t>(state);
  return number < kNames.size() ? kNames[number] : "unknown";
}

}  // namespace stilt::hal
