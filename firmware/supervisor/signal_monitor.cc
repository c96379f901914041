#include "firmware/supervisor/signal_monitor.h"

#include <algorithm>
#include <cmath>

namespace stilt::supervisor {
namespace {

using hal::JointReading;
using hal::kJoints;

constexpr double kTorsoTime_s = 0.2;
constexpr double kTorqueTime_s = 0.2;
constexpr double kFollowingTime_s = 0.05;

double seconds(std::int64_t ns) noexcept { return 1e-9 * static_cast<double>(ns); }

/// One step of y' = (x - y) / T; no value counts as 0.
double low_pass(double before, double value, double step_s, double time_s) noexcept {
  const double share = step_s / (step_s + time_s);
  return before + share * ((std::isfinite(value) ? value : 0.0) - before);
}

}  // namespace

const Signals& SignalMonitor::update(const SignalInputs& inputs) noexcept {
  const double step_s = seconds(inputs.time_ns - time_ns_);
  const bool first = time_ns_ == 0;
  time_ns_ = inputs.time_ns;
  if (first) {
    joints_ = inputs.joints;
    base_ = inputs.base;
    return signals_;
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    const JointReading& joint = inputs.joints[i];
    const double more_Nm = joint.torque_Nm - inputs.asked_torque_Nm[i];
    const double off_rad = std::abs(joint.position_rad - inputs.planned_position_rad[i]);
    signals_.torque_mismatch_Nm[i] = low_pass(signals_.torque_mismatch_Nm[i], more_Nm, step_s, kTorqueTime_s);
    signals_.asked_torque_Nm[i] =
        low_pass(signals_.asked_torque_Nm[i], std::abs(inputs.asked_torque_Nm[i]), step_s, kTorqueTime_s);
    signals_.following_error_rad[i] =
        low_pass(signals_.following_error_rad[i], off_rad, step_s, kFollowingTime_s);
  }
  compare_encoders(inputs.joints);
  compare_torso(inputs.base);
  return signals_;
}

double encoder_jump_rad(const JointReading& before, const JointReading& now) noexcept {
  const double mean_rad_s = 0.5 * (now.velocity_rad_s + before.velocity_rad_s);
  const double moved_rad = mean_rad_s * seconds(now.time_ns - before.time_ns);
  const double jump_rad = std::abs(now.position_rad - before.position_rad - moved_rad);
  return std::isfinite(jump_rad) ? jump_rad : 0.0;
}

void SignalMonitor::compare_encoders(const hal::JointReadings& joints) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    signals_.encoder_jump_rad[i] = encoder_jump_rad(joints_[i], joints[i]);
  }
  joints_ = joints;
}

void SignalMonitor::compare_torso(const hal::BaseReading& base) noexcept {
  if (base.time_ns == base_.time_ns) return;
  const double step_s = seconds(base.time_ns - base_.time_ns);
  const double mean_rad_s = 0.5 * (base.pitch_rate_rad_s + base_.pitch_rate_rad_s);
  const double change_rad = base.pitch_rad - base_.pitch_rad - mean_rad_s * step_s;
  const double kept = kTorsoTime_s / (kTorsoTime_s + std::max(step_s, 0.0));
  signals_.torso_mismatch_rad =
      std::isfinite(change_rad) ? kept * (signals_.torso_mismatch_rad + change_rad) : 0.0;
  base_ = base;
}

hal::JointValues asked_torque_Nm(const hal::JointCommands& commands,
                                 const hal::JointReadings& measured) noexcept {
  hal::JointValues asked_Nm{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const hal::JointCommand& command = commands[i];
    const double law_Nm = command.torque_Nm +
                          command.kp_Nm_rad * (command.position_rad - measured[i].position_rad) +
                          command.kd_Nms_rad * (command.velocity_rad_s - measured[i].velocity_rad_s);
    const double limit_Nm = command.torque_limit_Nm;
    asked_Nm[i] = std::isfinite(law_Nm) ? std::clamp(law_Nm, -limit_Nm, limit_Nm) : command.torque_Nm;
  }
  return asked_Nm;
}

}  // namespace stilt::supervisor
