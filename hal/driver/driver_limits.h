#pragma once

#include <string_view>

namespace stilt::hal {

/// The largest gains that a driver gives, and the steps of their fields, at its own shaft and in its own
/// unit. What is less than a step may arrive as 0.
struct GainLimits {
  double kp = 0;
  double kd = 0;
  double kp_step = 0;
  double kd_step = 0;
  double unit_rad = 1;  ///< the angle that the gains count in: 1, or 2 pi for gains per revolution
  std::string_view kp_unit = "Nm/rad";
  std::string_view kd_unit = "Nm s/rad";
};

/// The farthest from 0 that the fields of a driver's frames carry, at its own shaft, either way.
struct FrameReach {
  double command_position_rad = 0;
  double command_velocity_rad_s = 0;
  double command_torque_Nm = 0;
  double reply_position_rad = 0;
  double reply_velocity_rad_s = 0;
};

}  // namespace stilt::hal
