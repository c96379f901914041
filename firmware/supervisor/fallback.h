#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/supervisor/parameters.h"
#include "firmware/supervisor/state.h"

/// What commands the joints when not everything is well: the levels, what faults ask for, and the one choice
/// between them. Pure, real-time safe.
namespace stilt::supervisor {

/// What commands the joints in a tick, the best first.
enum class FallbackLevel : std::uint8_t {
  plan,           ///< the torque law on a plan newer than plan_feedback_after_s
  plan_feedback,  ///< the torque law on an aged plan; all of the plan's feedback acts
  gait,           ///< a gait of the library, tracked by the joints without planning
  hold,           ///< position control of the measured pose
  sit,            ///< position control on the way to the sitting pose
  damp,           ///< resistance only
  off,            ///< nothing
};
inline constexpr std::size_t kFallbackLevels = 7;

/// A number that is no level is "unknown".
[[nodiscard]] constexpr const char* name(FallbackLevel level) noexcept {
  constexpr std::array<const char*, kFallbackLevels> kNames = {"plan", "plan_feedback", "gait", "hold",
                                                               "sit",  "damp",          "off"};
  const auto number = static_cast<std::size_t>(level);
  return number < kNames.size() ? kNames[number] : "unknown";
}

/// What a fault asks for, the harder the later.
enum class Reaction : std::uint8_t {
  none,
  warn,  ///< report
  slow,  ///< walking becomes stepping in place, and stepping standing
  /// Hold the measured pose, for less than missed_damp_ticks: by then replies are back, or it is damped.
  hold,
  /// Walking becomes stepping in place at once, standing after slow_down_s, sitting after as much again, and
  /// damping after sit_s: 5 s with the shipped configuration. On a gait alone it sits instead of standing,
  /// and without plan and gait at once.
  sit,
  damp,  ///< damp the joints
  off,   ///< the motors are disabled
};
inline constexpr std::size_t kReactions = 7;

/// A number that is no reaction is "unknown".
[[nodiscard]] constexpr const char* name(Reaction reaction) noexcept {
  constexpr std::array<const char*, kReactions> kNames = {"none", "warn", "slow", "hold",
                                                          "sit",  "damp", "off"};
  const auto number = static_cast<std::size_t>(reaction);
  return number < kNames.size() ? kNames[number] : "unknown";
}

/// The best level that a reaction allows.
[[nodiscard]] constexpr FallbackLevel best_level(Reaction reaction) noexcept {
  constexpr std::array<FallbackLevel, kReactions> kLevels = {
      FallbackLevel::plan, FallbackLevel::plan, FallbackLevel::plan, FallbackLevel::hold,
      FallbackLevel::sit,  FallbackLevel::damp, FallbackLevel::off};
  return kLevels[static_cast<std::size_t>(reaction)];
}

/// How a plan can be followed.
enum class PlanUse : std::uint8_t {
  none,          ///< there is none to follow, or it is older than stale_plan_s and no gait begins later
  as_it_is,      ///< newer than plan_feedback_after_s
  with_feedback  ///< older than that: all of its feedback acts
};

/// The one judgement of a plan.
/// @param exists  a plan of this stance episode that has not ended; after a gait, with the gait's contact
/// mode
/// @param age_s   since the state it started from; NaN counts as too old
[[nodiscard]] constexpr PlanUse plan_use(bool exists, double age_s,
                                         const SupervisorParameters& parameters) noexcept {
  if (!exists || !(age_s < parameters.stale_plan_s)) return PlanUse::none;
  return age_s < parameters.plan_feedback_after_s ? PlanUse::as_it_is : PlanUse::with_feedback;
}

/// What the torque law could follow in a tick.
struct Followable {
  PlanUse plan = PlanUse::none;
  bool gait = false;           ///< a gait of the library is in step with the robot
  bool gait_selected = false;  ///< and is preferred to plans on purpose
};

/// The state bounds the level from above: only states that track reach plan and gait; the level of states
/// that drive nothing is off.
/// @param reaction  to the present and the latched faults; in states that track, without sit, which changes
///                  the state
[[nodiscard]] FallbackLevel select_level(State state, Reaction reaction,
                                         const Followable& followable) noexcept;

}  // namespace stilt::supervisor
