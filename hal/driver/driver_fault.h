#pragma once

#include <cstddef>
#include <cstdint>

namespace stilt::hal {

/// Fault that a motor driver reports, the same names for every vendor. The vendor's own number is kept
/// beside it.
enum class DriverFault : std::uint8_t {
  none,
  over_voltage,
  under_voltage,
  over_current,
  driver_over_temperature,
  motor_over_temperature,
  encoder,             ///< rotor or output position not known
  lost_communication,  ///< its watchdog expired
  overload,
  configuration,  ///< not calibrated, or set up for something else
  gate_driver,
  position_limit,
  velocity_limit,
  emergency_stop,
  other,
};
inline constexpr std::size_t kDriverFaults = 15;

[[nodiscard]] constexpr const char* name(DriverFault fault) noexcept {
  switch (fault) {
    case DriverFault::none:
      return "none";
    case DriverFault::over_voltage:
      return "over voltage";
    case DriverFault::under_voltage:
      return "under voltage";
    case DriverFault::over_current:
      return "over current";
    case DriverFault::driver_over_temperature:
      return "driver over temperature";
    case DriverFault::motor_over_temperature:
      return "motor over temperature";
    case DriverFault::encoder:
      return "encoder";
    case DriverFault::lost_communication:
      return "lost communication";
    case DriverFault::overload:
      return "overload";
    case DriverFault::configuration:
      return "configuration";
    case DriverFault::gate_driver:
      return "gate driver";
    case DriverFault::position_limit:
      return "position limit";
    case DriverFault::velocity_limit:
      return "velocity limit";
    case DriverFault::emergency_stop:
      return "emergency stop";
    case DriverFault::other:
      return "other";
  }
  return "other";
}

}  // namespace stilt::hal
