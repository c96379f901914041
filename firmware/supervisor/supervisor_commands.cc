#include <algorithm>

#include "firmware/supervisor/safe_commands.h"
#include "firmware/supervisor/supervisor.h"

// What the joints get at each level.
namespace stilt::supervisor {

/// Position control commands the joints while what carried them fades. Over hold_ramp_s the gains grow from
/// 0 to their own, and the torque falls from that of the last plan or gait to 0.
hal::JointCommands Supervisor::unloading(const hal::JointValues& pose_rad) const noexcept {
  const double ramp_s = parameters_.hold_ramp_s;
  const double share = ramp_s > 0 ? std::clamp(since_s(hold_ns_) / ramp_s, 0.0, 1.0) : 1.0;
  hal::JointCommands commands = held(pose_rad, share, limits_, parameters_);
  for (std::size_t i = 0; i < commands.size(); ++i) {
    commands[i].torque_Nm = (1 - share) * followed_[i].torque_Nm;
  }
  return commands;
}

hal::JointCommands Supervisor::commands_of_level(const hal::JointCommands& wanted) const noexcept {
  switch (output_.level) {
    case FallbackLevel::plan:
    case FallbackLevel::plan_feedback:
    case FallbackLevel::gait:
      return blend_in(wanted, stand_pose_rad_, output_.ramp, parameters_);
    case FallbackLevel::hold:
      return unloading(level_pose_rad_);
    case FallbackLevel::sit: {
      const double share = parameters_.sit_s > 0 ? since_s(level_ns_) / parameters_.sit_s : 1.0;
      return unloading(pose_between_rad(level_pose_rad_, sitting_pose_rad(parameters_), share));
    }
    case FallbackLevel::damp:
    case FallbackLevel::off:
      break;
  }
  return damped(measured_, limits_, parameters_);
}

Action Supervisor::bound(const hal::JointCommands& wanted, hal::JointCommands& commands) noexcept {
  if (output_.state == State::boot || output_.state == State::calibrate) return Action::silent;
  const bool alone = drivers_are_ == DriversAre::left_alone && output_.state != State::off;
  if (alone) return was_up_ ? Action::disable : Action::silent;
  if (output_.level == FallbackLevel::off) return Action::disable;
  commands = commands_of_level(wanted);
  if (!finite(commands)) {
    command_not_finite_ = true;
    commands = damped(measured_, limits_, parameters_);
  }
  commands = bounded(commands, measured_, derated(limits_, measured_, parameters_));
  if (output_.level <= FallbackLevel::gait) followed_ = commands;
  return Action::commands;
}

}  // namespace stilt::supervisor
