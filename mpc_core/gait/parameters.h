#pragma once

namespace stilt::gait {

/// Timing and shape of a step. Source of the defaults: docs/tuning.md.
struct GaitParameters {
  double single_support_s = 0.3;  ///< duration of single support
  double double_support_s = 0.0;  ///< duration of double support between two steps; 0: the feet swap at once
  double swing_height_m = 0.06;   ///< height of the swing foot above the ground at mid-swing
  double touchdown_velocity_m_s = -0.2;  ///< vertical velocity of the swing reference at touch-down
  double stand_half_width_m = 0.15;      ///< standing: distance of each foot from the hip, one foot ahead
  double switch_lead_s =
      0.3;  ///< least time from the command to the first lift-off, from standing to stepping
};

/// Heuristic reference of the base.
struct ReferenceParameters {
  double base_height_m = 0.80;
  double base_pitch_rad = 0.0;
  double speed_ramp_m_s2 = 1.0;      ///< rate of change of the speed reference
  double speed_trim_1_s = 0.5;       ///< speed added for each metre behind the commanded progress
  double speed_trim_max_m_s = 0.15;  ///< largest trim; the distance to make up saturates with it
};

}  // namespace stilt::gait
