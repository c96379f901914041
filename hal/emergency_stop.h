#pragma once

#include <cstdint>

namespace stilt::hal {

enum class EmergencyStopState : std::uint8_t {
  released,  ///< said so recently
  pressed,
  unknown,  ///< silent for too long, or never heard: to be treated as pressed
  absent,   ///< this robot has no such input
};

/// The emergency stop as an input of the program. The switch itself must also cut the power: this only
/// reports it.
class EmergencyStop {
 public:
  [[nodiscard]] virtual EmergencyStopState read_emergency_stop(std::int64_t now_ns) noexcept = 0;

 protected:
  ~EmergencyStop() = default;
};

}  // namespace stilt::hal
