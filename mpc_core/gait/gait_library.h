#pragma once

#include "mpc_core/gait/hzd_gait.h"

namespace stilt::gait {

/// Result of adding a gait to a library.
enum class LibraryStatus {
  ok,
  full,               ///< the library holds kMaxGaits
  motion_unknown,     ///< the gait has outputs but no motion
  speeds_not_rising,  ///< the speed is not above that of the gait before
  another_shape,      ///< step time or degree of the motion differs from those of the first gait
};

/// Gaits over a range of speeds, slowest first, all with the same step time and degree of the motion. A gait
/// for a speed in between blends the coefficients of its two neighbours. Fixed memory: filled at start-up,
/// read in real time.
class GaitLibrary {
 public:
  static constexpr int kMaxGaits = 32;
  static constexpr double kStepTimeTolerance_s = 1e-4;

  void clear() noexcept { count_ = 0; }
  [[nodiscard]] LibraryStatus add(const HzdGait& gait) noexcept;

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] const HzdGait& gait(int index) const noexcept { return gaits_[index]; }
  /// Step time of the first gait, s; 0 when the library is empty.
  [[nodiscard]] double step_time_s() const noexcept { return count_ > 0 ? gaits_[0].step_time_s : 0.0; }

  /// Computes the gait for a speed. Motion, speed, step length and step time are blended linearly. Outputs
  /// and feedback are blended when both neighbours have the same phase and degree; otherwise those of the
  /// nearer neighbour are used. A speed beyond the range gives the gait at its end. Needs at least one gait.
  /// Real-time safe.
  void blend(double speed_m_s, HzdGait& result) const noexcept;

  /// The motion of blend(speed_m_s) at s = t / step time, without outputs. Real-time safe.
  [[nodiscard]] GaitPoint motion_at(double speed_m_s, double s) const noexcept;

 private:
  /// The two gaits around a speed, and the weight of the faster one.
  struct Neighbours {
    int slower, faster;
    double share;
  };
  [[nodiscard]] Neighbours around(double speed_m_s) const noexcept;

  HzdGait gaits_[kMaxGaits];
  int count_ = 0;
};

}  // namespace stilt::gait
