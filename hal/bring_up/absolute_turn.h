#pragma once

#include <cmath>
#include <optional>

namespace stilt::hal {

/// An absolute encoder repeats every period_rad. Adds the number of whole periods that puts its angle into
/// the joint's travel [minimum_rad, maximum_rad]. Nothing when no number does, or more than one. Then the
/// angle is ambiguous, and the joint must not be enabled. Real-time safe.
[[nodiscard]] inline std::optional<double> only_turn(double angle_rad, double period_rad, double minimum_rad,
                                                     double maximum_rad) noexcept {
  if (!std::isfinite(angle_rad) || !(period_rad > 0) || !(minimum_rad <= maximum_rad)) return std::nullopt;
  const double first = std::ceil((minimum_rad - angle_rad) / period_rad);
  const double last = std::floor((maximum_rad - angle_rad) / period_rad);
  if (first != last) return std::nullopt;
  return angle_rad + first * period_rad;
}

/// A joint without a travel may be anywhere, in any turn of its encoder: its offset is not known yet.
[[nodiscard]] inline bool any_turn(double minimum_rad, double maximum_rad) noexcept {
  return std::isinf(minimum_rad) && std::isinf(maximum_rad);
}

}  // namespace stilt::hal
