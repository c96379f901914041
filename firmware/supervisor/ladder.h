#pragma once

#include <cstdint>

#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/parameters.h"
#include "firmware/supervisor/state.h"

namespace stilt::supervisor {

/// What commands the joints in a tick: the best thing that is possible, from the top down.
enum class Rung : std::uint8_t {
  new_plan,    ///< the torque law on a plan as young as plans should be
  older_plan,  ///< the torque law on the plan before, with its feedback gains
  gait,        ///< a gait of the library, tracked by the joints without planning
  hold,        ///< position control of the measured pose
  sit,         ///< position control on the way to the sitting pose
  damp,        ///< resistance only
  off,         ///< nothing
};

[[nodiscard]] constexpr const char* name(Rung rung) noexcept {
  constexpr const char* kNames[] = {"new_plan", "older_plan", "gait", "hold", "sit", "damp", "off"};
  return kNames[static_cast<int>(rung)];
}

struct LadderInputs {
  State state = State::boot;
  Reaction reaction = Reaction::none;  ///< to the present and the latched faults
  bool has_plan = false;               ///< a plan that has not ended
  bool has_gait = false;               ///< a gait of the library is in step with the robot
  double plan_age_s = 0;               ///< since the state it started from; NaN counts as too old
};

/// The ladder of next best things. The state bounds it from above: only states that track reach the plans,
/// and no state but fault and off lets go. Pure, real-time.
[[nodiscard]] Rung choose_rung(const LadderInputs& inputs, const SupervisorParameters& parameters) noexcept;

}  // namespace stilt::supervisor
