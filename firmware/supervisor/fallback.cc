#include "firmware/supervisor/fallback.h"

#include <algorithm>

namespace stilt::supervisor {
namespace {

FallbackLevel level_to_follow(const Followable& followable) noexcept {
  if (followable.gait && followable.gait_selected) return FallbackLevel::gait;
  switch (followable.plan) {
    case PlanUse::as_it_is:
      return FallbackLevel::plan;
    case PlanUse::with_feedback:
      return FallbackLevel::plan_feedback;
    case PlanUse::none:
      break;
  }
  return followable.gait ? FallbackLevel::gait : FallbackLevel::hold;
}

}  // namespace

FallbackLevel select_level(State state, Reaction reaction, const Followable& followable) noexcept {
  const FallbackLevel allowed = best_level(reaction);
  switch (state) {
    case State::boot:
    case State::idle:
    case State::calibrate:
    case State::off:
    case State::watch:
      return FallbackLevel::off;
    case State::ready:
      return FallbackLevel::damp;
    case State::fault:
      return std::max(allowed, FallbackLevel::damp);
    case State::sit:
      return std::clamp(allowed, FallbackLevel::sit, FallbackLevel::damp);
    case State::stand:
    case State::step:
    case State::walk:
      return std::min(std::max(level_to_follow(followable), allowed), FallbackLevel::damp);
  }
  return FallbackLevel::damp;
}

}  // namespace stilt::supervisor
