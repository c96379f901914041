#pragma once

#include <cstdint>
#include <limits>

namespace stilt::hal {

/// Readings of the torso sensors. A channel that no sensor provides stays NaN.
struct BaseReading {
  double pitch_rad = std::numeric_limits<double>::quiet_NaN();         ///< about +y: positive leans forward
  double pitch_rate_rad_s = std::numeric_limits<double>::quiet_NaN();  ///< about +y
  double acceleration_x_m_s2 = std::numeric_limits<double>::quiet_NaN();  ///< specific force, base frame
  double acceleration_z_m_s2 = std::numeric_limits<double>::quiet_NaN();  ///< specific force, base frame
  double left_foot_force_N = std::numeric_limits<double>::quiet_NaN();  ///< normal force of a contact sensor
  double right_foot_force_N = std::numeric_limits<double>::quiet_NaN();
  std::int64_t time_ns = 0;             ///< when the pitch arrived, CLOCK_MONOTONIC; 0: never
  std::uint32_t missed_replies = 0;     ///< reads in a row without a new pitch or rate since one was due
  std::uint32_t unchanged_replies = 0;  ///< reads over which pitch and rate came with the very same bits
  std::uint32_t malformed = 0;          ///< frames of the sensor that could not be decoded, since start
};

/// How a read of the sensor ended.
enum class TorsoSensorStatus : std::uint8_t {
  ok,     ///< a new pitch
  stale,  ///< nothing new
};

}  // namespace stilt::hal
