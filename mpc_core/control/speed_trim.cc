#include "mpc_core/control/speed_trim.h"

#include <algorithm>
#include <cmath>

namespace stilt::control {

double SpeedTrim::update(const TrimInput& input, const gait::ReferenceParameters& parameters) noexcept {
  if (!input.stepping) {
    reset();
    time_s_ = input.time_s;
    return 0.0;
  }
  progress_m_ += input.speed_reference_m_s * (input.time_s - time_s_);
  time_s_ = input.time_s;
  const bool landed = (input.contact[0] && !contact_[0]) || (input.contact[1] && !contact_[1]);
  contact_ = input.contact;
  if (landed) touch_down({input.time_s, input.base_x_m, progress_m_}, parameters);
  return trim_m_s_;
}

void SpeedTrim::touch_down(const Touchdown& now, const gait::ReferenceParameters& parameters) noexcept {
  if (steps_ == 2) {
    const double two_steps_s = now.time_s - past_[1].time_s;
    const double speed_m_s = (now.base_x_m - past_[1].base_x_m) / two_steps_s;
    const double reference_m_s = (now.progress_m - past_[1].progress_m) / two_steps_s;
    const bool steady =
        has_mean_ && std::abs(speed_m_s - mean_speed_m_s_) <= parameters.speed_trim_steady_m_s;
    if (steady) {
      const double error_m_s = std::clamp(reference_m_s - speed_m_s, -parameters.speed_trim_max_m_s,
                                          parameters.speed_trim_max_m_s);
      const double change_m_s = parameters.speed_trim_1_s * error_m_s * (now.time_s - past_[0].time_s);
      trim_m_s_ =
          std::clamp(trim_m_s_ + change_m_s, -parameters.speed_trim_max_m_s, parameters.speed_trim_max_m_s);
    }
    mean_speed_m_s_ = speed_m_s;
    has_mean_ = true;
  }
  past_[1] = past_[0];
  past_[0] = now;
  steps_ = std::min(steps_ + 1, 2);
}

}  // namespace stilt::control
