#pragma once

/// Trajectory of a swing foot over its phase s in [0, 1].
namespace stilt::gait {

/// Position, velocity and acceleration of one coordinate, SI units.
struct Motion {
  double position;
  double velocity;
  double acceleration;
};

/// Minimum-jerk motion from `start` to `end` in `duration`:
///   p = start + (end - start)(10 s^3 - 15 s^4 + 6 s^5).
[[nodiscard]] constexpr Motion minimum_jerk(double start, double end, double s, double duration) noexcept {
  const double d = end - start;
  return {start + d * s * s * s * (10.0 + s * (-15.0 + 6.0 * s)),
          d * 30.0 * s * s * (1.0 + s * (-2.0 + s)) / duration,
          d * 60.0 * s * (1.0 + s * (-3.0 + 2.0 * s)) / (duration * duration)};
}

/// Height of the swing foot. It rises from rest on the ground, passes `apex` at s = 1/2 and reaches the
/// ground at s = 1 with `touchdown_velocity`:
///   z = 16 h s^2 (1 - s)^2 + v T s^2 (s - 1),  h = apex + v T / 8.
/// With a profile flat at its end, every small error would make the foot land late or early.
[[nodiscard]] constexpr Motion swing_height(double apex, double touchdown_velocity, double s,
                                            double duration) noexcept {
  const double slope = touchdown_velocity * duration;
  const double h = 16.0 * (apex + slope / 8.0);
  return {h * s * s * (1.0 - s) * (1.0 - s) + slope * s * s * (s - 1.0),
          (h * 2.0 * s * (1.0 - s) * (1.0 - 2.0 * s) + slope * s * (3.0 * s - 2.0)) / duration,
          (h * (2.0 + s * (-12.0 + 12.0 * s)) + slope * (6.0 * s - 2.0)) / (duration * duration)};
}

}  // namespace stilt::gait
