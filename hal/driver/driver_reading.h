#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hal/driver/driver_fault.h"

namespace stilt::hal {

/// Whether a driver follows commands, as it reports.
enum class DriverState : std::uint8_t {
  unknown,  ///< has not answered yet, or does not report it
  idle,     ///< powered, no torque
  enabled,  ///< follows commands
  fault,    ///< see the fault
};
inline constexpr std::size_t kDriverStates = 4;

/// What a driver has reported, at its own shaft; NaN: not reported.
struct DriverReading {
  static constexpr double kNotReported = std::numeric_limits<double>::quiet_NaN();

  double position_rad = kNotReported;
  double velocity_rad_s = kNotReported;
  double torque_Nm = kNotReported;  ///< estimated
  double driver_temperature_C = kNotReported;
  double motor_temperature_C = kNotReported;
  double supply_V = kNotReported;
  double fine_position_rad = kNotReported;  ///< of a frame that refines the position of the others
  DriverState state = DriverState::unknown;
  DriverFault fault = DriverFault::none;
  std::uint32_t fault_code = 0;  ///< vendor code

  /// Of the newest frame alone.
  bool has_motion = false;                       ///< position and velocity are new
  bool has_started = false;                      ///< the driver reports that it had no power
  double encoder_position_rad = kNotReported;    ///< of an extra encoder
  double encoder_velocity_rad_s = kNotReported;  ///< of an extra encoder

  void begin_frame() noexcept {
    has_motion = has_started = false;
    encoder_position_rad = encoder_velocity_rad_s = kNotReported;
  }
  /// A fault outweighs the state that the driver reports.
  void set_state(DriverState reported, DriverFault reported_fault, std::uint32_t code) noexcept {
    state = reported_fault == DriverFault::none ? reported : DriverState::fault;
    fault = reported_fault;
    fault_code = code;
  }
};

/// What a driver shall do, at its own shaft: tau = torque_Nm + kp (position - q) + kd (velocity - v).
struct DriverCommand {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double torque_Nm = 0;
  double kp_Nm_rad = 0;
  double kd_Nms_rad = 0;
  double torque_limit_Nm = 0;
  double watchdog_s = 0;
  double law_Nm = 0;  ///< tau at the newest reading, limited: for drivers without gains of their own
  bool asks_motor_temperature = false;  ///< for drivers that report it on request, beside their reply
};

}  // namespace stilt::hal
