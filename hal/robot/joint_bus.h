#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hal/driver/driver_reading.h"

namespace stilt::hal {

inline constexpr std::size_t kJoints = 4;  ///< hip_L, knee_L, hip_R, knee_R

/// What is known of one joint. Rotations about +y of the world as everywhere (positive swings the lower link
/// to -x).
struct JointReading {
  double position_rad = std::numeric_limits<double>::quiet_NaN();
  double velocity_rad_s = std::numeric_limits<double>::quiet_NaN();
  double torque_Nm = std::numeric_limits<double>::quiet_NaN();  ///< at the joint, as the driver estimates it
  double driver_temperature_C = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not reported
  double motor_temperature_C = std::numeric_limits<double>::quiet_NaN();   ///< NaN: not reported
  double supply_V = std::numeric_limits<double>::quiet_NaN();              ///< NaN: not reported
  std::int64_t time_ns = 0;             ///< when the position arrived, CLOCK_MONOTONIC; 0: never
  std::uint32_t missed_replies = 0;     ///< reads in a row without a new position since one was due. Of a
                                        ///< driver that reports by its own clock at least the writes in a
                                        ///< row of which nothing left for its bus
  std::uint32_t unchanged_replies = 0;  ///< new positions in a row with the very same bits
  std::uint32_t malformed = 0;          ///< frames of this joint that could not be decoded, since start
  DriverState state = DriverState::unknown;
  DriverFault fault = DriverFault::none;
  std::uint32_t fault_code = 0;  ///< vendor code
};

/// What one joint shall do: tau = torque_Nm + kp (position - q) + kd (velocity - v), within the torque limit.
struct JointCommand {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double torque_Nm = 0;
  double kp_Nm_rad = 0;
  double kd_Nms_rad = 0;
  double torque_limit_Nm = 0;  ///< limits the law in drivers that take it, and where an ODrive's is computed
};

using JointValues = std::array<double, kJoints>;  ///< one quantity of every joint
using JointReadings = std::array<JointReading, kJoints>;
using JointCommands = std::array<JointCommand, kJoints>;

/// How a read or write of all joints ended.
enum class JointBusStatus : std::uint8_t {
  ok,
  incomplete,  ///< read: a joint sent nothing new that was due. write: a command was withheld or dropped, or
               ///< its driver has not answered
  refused,     ///< write: a command is not finite; nothing at all was sent
  bus_off,     ///< a bus is off
  disconnected,  ///< a bus is gone
};
inline constexpr std::size_t kJointBusStatuses = 5;

}  // namespace stilt::hal
