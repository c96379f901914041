#pragma once

#include "mpc_core/gait/hzd_gait.h"

namespace stilt::gait {

enum class LibraryStatus {
  ok,
  full,               ///< kMaxGaits are in it
  motion_unknown,     ///< the gait has outputs alone
  speeds_not_rising,  ///< not faster than the one before
  another_shape,      ///< step time or degree of the motion differs from that of the first
};

/// Gaits over a range of speeds, slowest first, all of one step time and one degree of the motion, so that a
/// gait for any speed between is a blend of its two neighbours' coefficients. Fixed memory: filled at
/// start-up, read in real time.
class GaitLibrary {
 public:
  static constexpr int kMaxGaits = 32;
  static constexpr double kStepTimeTolerance_s = 1e-4;

  void clear() noexcept { count_ = 0; }
  [[nodiscard]] LibraryStatus add(const HzdGait& gait) noexcept;

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] const HzdGait& gait(int index) const noexcept { return gaits_[index]; }
  /// Of the first gait; 0 when empty.
  [[nodiscard]] double step_time_s() const noexcept { return count_ > 0 ? gaits_[0].step_time_s : 0.0; }

  /// The gait for a speed, in `result`: motion, speed, step length and step time are blended linearly, speeds
  /// beyond the range take the gait at its end. Outputs and feedback are blended when both neighbours have
  /// the same phase and degree, and are those of the nearer one otherwise. Needs at least one gait. Real-time
  /// safe.
  void blend(double speed_m_s, HzdGait& result) const noexcept;

  /// The motion of blend(speed_m_s) at s = t / step time, without the outputs. Real-time safe.
  [[nodiscard]] GaitPoint motion_at(double speed_m_s, double s) const noexcept;

 private:
  /// The gaits around a speed, and the share of the faster one.
  struct Neighbours {
    int slower, faster;
    double share;
  };
  [[nodiscard]] Neighbours around(double speed_m_s) const noexcept;

  HzdGait gaits_[kMaxGaits];
  int count_ = 0;
};

}  // namespace stilt::gait
