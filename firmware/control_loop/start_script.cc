#include "firmware/control_loop/start_script.h"

namespace stilt::control_loop {

using supervisor::RequestKind;
using supervisor::State;

namespace {

bool is_at(const gait::GaitCommand& goal, State state, double ramp) noexcept {
  switch (goal.kind) {
    case gait::GaitKind::stand:
      return state == State::stand && ramp >= 1.0;
    case gait::GaitKind::step:
      return state == State::step;
    case gait::GaitKind::walk:
      return state == State::walk;
  }
  return false;
}

}  // namespace

/// Each step follows from the one before only.
void StartScript::ask(RequestKind kind) noexcept {
  if (static_cast<int>(kind) <= static_cast<int>(command_.request.kind)) return;
  command_.request.kind = kind;
  ++command_.request.number;
}

OperatorCommand StartScript::command(double time_s, State state, double ramp) noexcept {
  if (duration_s_ > 0.0 && time_s >= duration_s_) command_.shut_down = true;
  if (!goal_) return command_;
  if (!command_.shut_down) reached_ = reached_ || is_at(*goal_, state, ramp);
  if (state != State::stand || ramp < 1.0) standing_since_s_ = time_s;
  const bool settled = state == State::stand && time_s - standing_since_s_ >= settle_s_;
  if (state == State::idle) ask(RequestKind::calibrate);
  if (state == State::ready) ask(RequestKind::stand);
  if (settled && goal_->kind == gait::GaitKind::step) ask(RequestKind::step);
  if (settled && goal_->kind == gait::GaitKind::walk) {
    ask(RequestKind::walk);
    command_.request.speed_m_s = goal_->speed_m_s;
  }
  return command_;
}

}  // namespace stilt::control_loop
