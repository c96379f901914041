#pragma once

#include <optional>

#include "firmware/control_loop/messages.h"
#include "firmware/supervisor/state.h"

namespace stilt::control_loop {

/// Does what an operator would who wants one gait for a while: drivers up, stand, settle, go, and after the
/// duration shut down. Asks for each thing once, so that a fault ends it. Pure but for its progress;
/// real-time safe.
class StartScript {
 public:
  /// @param goal       where to go; none: ask for nothing but the end
  /// @param settle_s   standing after the torque law is blended in, before the first step
  /// @param duration_s controller's clock at which to shut down; 0: never
  StartScript(const std::optional<gait::GaitCommand>& goal, double settle_s, double duration_s) noexcept
      : goal_(goal), settle_s_(settle_s), duration_s_(duration_s) {}

  /// What to command now that the supervisor is in `state` with the torque law's share `ramp`.
  [[nodiscard]] OperatorCommand command(double time_s, supervisor::State state, double ramp) noexcept;

  /// The duration is over and the robot was never where the goal is: standing on the torque law alone,
  /// stepping or walking.
  [[nodiscard]] bool missed() const noexcept { return command_.shut_down && goal_ && !reached_; }

 private:
  void ask(supervisor::RequestKind kind) noexcept;

  std::optional<gait::GaitCommand> goal_;
  double settle_s_;
  double duration_s_;
  OperatorCommand command_;
  double standing_since_s_ = -1.0;
  bool reached_ = false;
};

}  // namespace stilt::control_loop
