#include "hal/moteus/moteus_trajectory.h"

#include <algorithm>
#include <cmath>

namespace stilt::hal::moteus {
namespace {

constexpr double kStep_s = 1.0 / 30000;  // period of the driver's loop
constexpr double kNearSteps = 10;        // of travel: then the position counts as reached
constexpr double kRestVelocity_rev_s = 0.05;

}  // namespace

bool MoteusTrajectory::limited() const noexcept {
  return !std::isnan(target_.velocity_limit_rev_s) || !std::isnan(target_.accel_limit_rev_s2);
}

void MoteusTrajectory::aim(const Target& target) noexcept {
  target_ = target;
  reached_ = false;
}

void MoteusTrajectory::start(double position_rev, double velocity_rev_s) noexcept {
  position_rev_ = position_rev;
  velocity_rev_s_ = std::abs(velocity_rev_s) < kRestVelocity_rev_s ? 0 : velocity_rev_s;
  started_ = true;
}

/// Towards the target as long as the way left is longer than the way to its velocity.
double MoteusTrajectory::acceleration(double velocity_rev_s) const noexcept {
  const double most = target_.accel_limit_rev_s2;
  if (velocity_rev_s_ > target_.velocity_limit_rev_s) return -most;
  if (velocity_rev_s_ < -target_.velocity_limit_rev_s) return most;
  const double ahead_rev = target_.position_rev - position_rev_;
  const double relative_rev_s = velocity_rev_s_ - velocity_rev_s;
  if (relative_rev_s * ahead_rev < 0 || ahead_rev == 0) return std::copysign(most, -relative_rev_s);
  const double stop_rev = relative_rev_s * relative_rev_s / (2 * most);
  if (std::abs(ahead_rev) > stop_rev) return std::copysign(most, ahead_rev);
  const double needed = relative_rev_s * relative_rev_s / (2 * std::abs(ahead_rev));
  return std::copysign(std::min(needed, most), -relative_rev_s);
}

void MoteusTrajectory::step(double step_s) noexcept {
  const double limit_rev_s = target_.velocity_limit_rev_s;
  const double wanted_rev_s = std::isnan(limit_rev_s)
                                  ? target_.velocity_rev_s
                                  : std::clamp(target_.velocity_rev_s, -limit_rev_s, limit_rev_s);
  const double before_rev_s = velocity_rev_s_;
  const double most = target_.accel_limit_rev_s2;
  if (reached_ || !limited()) {
    velocity_rev_s_ = wanted_rev_s;
  } else if (std::isnan(target_.position_rev)) {
    const double change_rev_s = wanted_rev_s - velocity_rev_s_;
    velocity_rev_s_ +=
        std::isnan(most) ? change_rev_s : std::clamp(change_rev_s, -most * step_s, most * step_s);
  } else if (std::isnan(most)) {
    velocity_rev_s_ = std::copysign(limit_rev_s, target_.position_rev - position_rev_);
    reached_ = std::abs(target_.position_rev - position_rev_) <= limit_rev_s * step_s;
  } else {
    velocity_rev_s_ += acceleration(wanted_rev_s) * step_s;
    const double relative_rev_s = std::abs(velocity_rev_s_ - wanted_rev_s);
    const bool same = relative_rev_s < most * step_s / 2 ||
                      (before_rev_s - wanted_rev_s) * (velocity_rev_s_ - wanted_rev_s) <= 0;
    const double near_rev = std::max(relative_rev_s, std::abs(wanted_rev_s)) * kNearSteps * step_s;
    reached_ = same && std::abs(target_.position_rev - position_rev_) <= near_rev;
    if (reached_) velocity_rev_s_ = wanted_rev_s;
  }
  position_rev_ += velocity_rev_s_ * step_s;
  target_.position_rev += wanted_rev_s * step_s;
}

void MoteusTrajectory::keep_within(const Bounds& bounds) noexcept {
  if (position_rev_ < bounds.minimum_rev) {
    position_rev_ = bounds.minimum_rev;
  } else if (position_rev_ > bounds.maximum_rev) {
    position_rev_ = bounds.maximum_rev;
  } else {
    return;
  }
  velocity_rev_s_ = 0;
}

void MoteusTrajectory::advance(double duration_s, double position_rev, double velocity_rev_s,
                               const Bounds& bounds) noexcept {
  if (!started_) start(position_rev, velocity_rev_s);
  if (!limited()) {
    if (!reached_ && !std::isnan(target_.position_rev)) position_rev_ = target_.position_rev;
    reached_ = true;
    velocity_rev_s_ = target_.velocity_rev_s;
    position_rev_ += velocity_rev_s_ * duration_s;
  } else {
    for (double left_s = duration_s; left_s > 0; left_s -= kStep_s) step(std::min(left_s, kStep_s));
  }
  keep_within(bounds);
}

}  // namespace stilt::hal::moteus
