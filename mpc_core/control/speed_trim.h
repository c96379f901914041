#pragma once

#include <array>

#include "mpc_core/gait/parameters.h"
#include "mpc_core/model/types.h"

namespace stilt::control {

/// What the trim needs of a plan's start.
struct TrimInput {
  double time_s = 0.0;
  double base_x_m = 0.0;
  double speed_reference_m_s = 0.0;  ///< without trim
  model::ContactMode contact;        ///< by schedule
  bool stepping = false;             ///< by schedule, after a solve with a plan; while false there is no trim
};

/// Integral trim of the speed reference. Steps track the commanded speed with a bias, a compromise between
/// the terms of the cost. At every touch-down
///
///   trim += speed_trim_1_s * (r - v) * (duration of the last step),   bounded
///
/// r, v: mean reference and mean speed over the last two steps; the error counts up to the largest trim. The
/// trim stays as it is while v differs by more than `speed_trim_steady_m_s` from its value one step earlier.
/// What a push changes is no bias, and an integral over it delays the recovery. Real-time safe.
class SpeedTrim {
 public:
  void reset() noexcept { *this = SpeedTrim{}; }

  /// Once per plan.
  /// @return the speed to add to the reference, m/s
  [[nodiscard]] double update(const TrimInput& input, const gait::ReferenceParameters& parameters) noexcept;

 private:
  struct Touchdown {
    double time_s, base_x_m, progress_m;
  };

  void touch_down(const Touchdown& now, const gait::ReferenceParameters& parameters) noexcept;

  std::array<Touchdown, 2> past_{};  ///< the last one, and the one before
  int steps_ = 0;                    ///< touch-downs in past_
  double mean_speed_m_s_ = 0.0;      ///< over the two steps before the last touch-down
  bool has_mean_ = false;
  double trim_m_s_ = 0.0;
  double progress_m_ = 0.0;  ///< integral of the reference
  double time_s_ = 0.0;
  model::ContactMode contact_{true, true};
};

}  // namespace stilt::control
