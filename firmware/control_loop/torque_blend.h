#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/supervisor/fallback.h"
#include "firmware/supervisor/parameters.h"
#include "hal/robot/joint_bus.h"

namespace stilt::control_loop {

/// Fades the jump of torque where what the joints follow changes: level, or gains. The first tick asks for
/// the torque of the tick before, and the difference falls to 0 linearly:
///
///   tau = tau_new(t) + (1 - t / T) (tau_before - tau_new(0))
///
/// From damping the supervisor's ramp leads to the law instead. Real-time safe.
class TorqueBlend {
 public:
  /// What decides the torques of a tick.
  struct Law {
    supervisor::FallbackLevel level = supervisor::FallbackLevel::off;
    std::uint32_t tuning = 0;
    bool operator==(const Law&) const = default;
  };

  void configure(double duration_s) noexcept {
    *this = TorqueBlend();
    duration_s_ = duration_s;
  }

  /// One tick on the ramp, or without plan and gait: nothing fades.
  void remember(const Law& law) noexcept {
    law_ = law;
    jump_Nm_ = {};
  }

  /// One tick.
  /// @param before_Nm  torque that the commands of the tick before ask for now
  /// @param wanted     of the law, which follows plan or gait
  void fade(const Law& law, double time_s, const hal::JointValues& before_Nm,
            hal::JointCommands& wanted) noexcept {
    if (law != law_) {
      law_ = law;
      start_s_ = time_s;
      for (std::size_t i = 0; i < hal::kJoints; ++i) jump_Nm_[i] = before_Nm[i] - wanted[i].torque_Nm;
    }
    const double left = duration_s_ > 0 ? std::clamp(1.0 - (time_s - start_s_) / duration_s_, 0.0, 1.0) : 0.0;
    for (std::size_t i = 0; i < hal::kJoints; ++i) wanted[i].torque_Nm += left * jump_Nm_[i];
  }

 private:
  double duration_s_ = 0.0;
  double start_s_ = 0.0;
  Law law_;
  hal::JointValues jump_Nm_{};
};

}  // namespace stilt::control_loop
