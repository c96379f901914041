#pragma once

namespace stilt::gait {

/// Timing and shape of a step. Source of the defaults: docs/tuning.md.
struct GaitParameters {
  double single_support_s = 0.25;  ///< duration of single support
  double double_support_s = 0.0;   ///< duration of double support between two steps; 0: the feet swap at once
  double swing_height_m = 0.07;    ///< height of the swing foot above the ground at mid-swing
  double touchdown_velocity_m_s = -0.2;  ///< vertical velocity of the swing reference at touch-down
  double stand_half_width_m = 0.15;      ///< standing: distance of each foot from the hip, one foot ahead
  double switch_lead_s =
      0.3;                  ///< least time from the command to the first lift-off, from standing to stepping
  bool catch_falls = true;  ///< whether a standing robot that would fall steps; see FallCatcher
  double catch_margin_m = 0.02;  ///< distance of the capture point to leaving the feet at which steps begin
  double catch_lead_s = 0.02;    ///< time from then to the first lift-off
  double catch_calm_m_s = 0.15;  ///< stepping ends after a step during which the base was slower
};

/// Heuristic reference of the base.
struct ReferenceParameters {
  double base_height_m = 0.80;
  double base_pitch_rad = 0.0;
  double speed_ramp_m_s2 = 1.0;  ///< rate of change of the speed reference
  /// The speed reference stays within this of the measured speed. A reference that a pushed robot cannot
  /// reach within a few steps places the feet where they drive it further away.
  double speed_follow_band_m_s = 0.6;
  double speed_follow_max_m_s = 1.5;  ///< a robot that is faster raises the reference up to this
  double foothold_gain_s = 0.35;      ///< shift of the next foothold for each m/s above the reference
  double foothold_gain_decay = 0.5;   ///< factor on the shift for each later foothold
  double foothold_shift_max_m = 0.3;
  double speed_trim_1_s = 0.8;          ///< change of the trim for each m/s of steady error (SpeedTrim)
  double speed_trim_steady_m_s = 0.03;  ///< an error is steady while the speed changes by less in a step
  double speed_trim_max_m_s = 0.15;     ///< largest trim
};

}  // namespace stilt::gait
