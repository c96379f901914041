#include "firmware/supervisor/ladder.h"

namespace stilt::supervisor {
namespace {

Rung best_while_tracking(const LadderInputs& inputs, const SupervisorParameters& parameters) noexcept {
  if (inputs.reaction >= Reaction::damp) return Rung::damp;
  if (inputs.reaction == Reaction::sit) return Rung::sit;
  if (inputs.reaction == Reaction::hold) return Rung::hold;
  if (!inputs.has_plan || !(inputs.plan_age_s < parameters.stale_plan_s)) {
    return inputs.has_gait ? Rung::gait : Rung::hold;
  }
  return inputs.plan_age_s < parameters.older_plan_s ? Rung::new_plan : Rung::older_plan;
}

}  // namespace

Rung choose_rung(const LadderInputs& inputs, const SupervisorParameters& parameters) noexcept {
  switch (inputs.state) {
    case State::boot:
    case State::idle:
    case State::calibrate:
    case State::off:
      return Rung::off;
    case State::ready:
      return Rung::damp;
    case State::fault:
      return inputs.reaction == Reaction::off ? Rung::off : Rung::damp;
    case State::sit:
      return inputs.reaction >= Reaction::damp ? Rung::damp : Rung::sit;
    case State::stand:
    case State::step:
    case State::walk:
      return best_while_tracking(inputs, parameters);
  }
  return Rung::damp;
}

}  // namespace stilt::supervisor
