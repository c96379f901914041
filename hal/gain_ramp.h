#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hal/robot/joint_bus.h"

namespace stilt::hal {

/// Takes over from limp joints: starts at the measured pose, never at zero, and grows gains and torques from
/// nothing over a time. The commanded position moves from the measured one to the wanted one with the same
/// fraction s:
///
///   position = q0 + s (wanted - q0), velocity = s wanted, gains and torque = s wanted, s from 0 to 1
///
/// Pure, real-time safe.
class GainRamp {
 public:
  /// @param measured  readings at the start, every position finite
  void start(std::int64_t now_ns, std::int64_t duration_ns, const JointReadings& measured) noexcept {
    start_ns_ = now_ns;
    duration_ns_ = duration_ns;
    for (std::size_t joint = 0; joint < kJoints; ++joint) start_rad_[joint] = measured[joint].position_rad;
  }

  /// 0 at the start, 1 when the wanted commands pass unchanged.
  [[nodiscard]] double fraction(std::int64_t now_ns) const noexcept {
    if (duration_ns_ <= 0) return 1;
    const double s = static_cast<double>(now_ns - start_ns_) / static_cast<double>(duration_ns_);
    return std::clamp(s, 0.0, 1.0);
  }

  [[nodiscard]] JointCommands ramped(std::int64_t now_ns, const JointCommands& wanted) const noexcept {
    const double s = fraction(now_ns);
    if (s >= 1) return wanted;
    JointCommands commands = wanted;
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      JointCommand& command = commands[joint];
      command.position_rad = start_rad_[joint] + s * (command.position_rad - start_rad_[joint]);
      command.velocity_rad_s *= s;
      command.torque_Nm *= s;
      command.kp_Nm_rad *= s;
      command.kd_Nms_rad *= s;
    }
    return commands;
  }

 private:
  std::int64_t start_ns_ = 0;
  std::int64_t duration_ns_ = 0;
  std::array<double, kJoints> start_rad_{};
};

}  // namespace stilt::hal
