#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// The states of the robot, and every way from one to another, as one table.
namespace stilt::supervisor {

/// States of the supervisor; docs/controller.md draws their transitions.
enum class State : std::uint8_t {
  boot,       ///< the emergency stop has not reported yet; nothing is sent
  idle,       ///< drivers are left alone, or kept off once they were up
  calibrate,  ///< drivers are brought up
  ready,      ///< drivers are enabled; the joints are damped
  stand,      ///< the torque law is blended in along a ramp, then stands
  step,       ///< steps in place
  walk,
  sit,    ///< the pose moves to the sitting pose
  fault,  ///< damped or off, until reset
  off,    ///< drivers are disabled; the end
  watch,  ///< `stiltd watch`: drivers are enabled, the joints limp; the supervisor is never there
};
inline constexpr std::size_t kStates = 11;

/// A number that is no state is "unknown".
[[nodiscard]] constexpr const char* name(State state) noexcept {
  constexpr std::array<const char*, kStates> kNames = {"boot", "idle", "calibrate", "ready", "stand", "step",
                                                       "walk", "sit",  "fault",     "off",   "watch"};
  const auto number = static_cast<std::size_t>(state);
  return number < kNames.size() ? kNames[number] : "unknown";
}

/// What the robot does there, a sentence without a full stop; also of a number that is no state.
[[nodiscard]] constexpr const char* description(State state) noexcept {
  constexpr std::array<const char*, kStates> kTexts = {
      "The emergency stop has not reported yet, nothing is sent",
      "The motor drivers are left alone",
      "The motor drivers are brought up",
      "The drivers are enabled, the joints are damped",
      "The torque law takes over and stands",
      "Steps in place",
      "Walks",
      "Moves to the sitting pose",
      "Damped, or the motors off, until the faults are reset",
      "The drivers are disabled, the end",
      "The drivers are enabled, the joints limp: nothing moves them but a hand"};
  const auto number = static_cast<std::size_t>(state);
  return number < kTexts.size() ? kTexts[number] : "Unknown to this program";
}

/// The torque law is in command.
[[nodiscard]] constexpr bool tracks(State state) noexcept {
  return state == State::stand || state == State::step || state == State::walk;
}

/// The joints may get torque that is more than damping.
[[nodiscard]] constexpr bool has_torque(State state) noexcept { return tracks(state) || state == State::sit; }

/// The joints are damped and get no other torque; in a fault the motors may be off instead.
[[nodiscard]] constexpr bool damps(State state) noexcept {
  return state == State::ready || state == State::fault;
}

/// The drivers get commands.
[[nodiscard]] constexpr bool drives(State state) noexcept { return has_torque(state) || damps(state); }

/// What makes a state end.
enum class Condition : std::uint8_t {
  emergency_stop_known,  ///< the emergency stop has reported, or had its time to
  bring_up_done,         ///< every driver is enabled
  sit_done,              ///< sit_s are over
  damp_fault,            ///< a fault that asks for damping, or for off
  sit_fault,             ///< a fault that asks to sit
  slow_fault,            ///< heartbeat_lost, now or since the newest order
  request_calibrate,     ///< requests: the operator's
  request_stand,
  request_step,
  request_walk,
  request_sit,
  request_reset,
  request_off,
  request_cut,
  shut_down,    ///< the program is to end
  lost_stance,  ///< the robot is too far from the standing pose
};

/// What must hold besides.
enum class Guard : std::uint8_t {
  always,
  ramp_done,      ///< the torque law is blended in
  ramping,        ///< it has not yet
  rising,         ///< less than half of it is: the robot has not carried itself yet
  cannot_step,    ///< there is neither a plan recent enough nor a gait to step with
  slowed_down,    ///< stepped in place for long enough
  at_rest,        ///< stood for long enough, and rests with both feet down, or has not rested for long
  damped,         ///< the joints were damped for damped_before_off_s, or the motors are off
  causes_gone,    ///< a reset is under way, after damping, and no fault that latches is present
  none_latched,   ///< no fault waits for a reset
  fit_to_stand,   ///< nor does one, and the robot is in a pose to stand up from
  fault_latched,  ///< one does
};

/// A row of the table of transitions.
struct Transition {
  State from;
  Condition condition;
  Guard guard;
  State to;
};

/// Every transition there is. Of those that apply the first is taken, one per tick.
inline constexpr auto kTransitions = std::to_array<Transition>({
    {State::boot, Condition::request_cut, Guard::always, State::off},
    {State::boot, Condition::shut_down, Guard::always, State::off},
    {State::boot, Condition::emergency_stop_known, Guard::always, State::idle},

    {State::idle, Condition::request_cut, Guard::always, State::off},
    {State::idle, Condition::damp_fault, Guard::always, State::fault},
    {State::idle, Condition::shut_down, Guard::always, State::off},
    {State::idle, Condition::request_off, Guard::always, State::off},
    {State::idle, Condition::request_calibrate, Guard::always, State::calibrate},

    {State::calibrate, Condition::request_cut, Guard::always, State::off},
    {State::calibrate, Condition::damp_fault, Guard::always, State::fault},
    {State::calibrate, Condition::shut_down, Guard::always, State::off},
    {State::calibrate, Condition::request_off, Guard::always, State::off},
    {State::calibrate, Condition::bring_up_done, Guard::always, State::ready},

    {State::ready, Condition::request_cut, Guard::always, State::off},
    {State::ready, Condition::damp_fault, Guard::always, State::fault},
    {State::ready, Condition::sit_fault, Guard::always, State::fault},
    {State::ready, Condition::shut_down, Guard::damped, State::off},
    {State::ready, Condition::request_off, Guard::damped, State::off},
    {State::ready, Condition::request_stand, Guard::fit_to_stand, State::stand},

    {State::stand, Condition::request_cut, Guard::always, State::off},
    {State::stand, Condition::damp_fault, Guard::always, State::fault},
    {State::stand, Condition::sit_fault, Guard::rising, State::fault},
    {State::stand, Condition::sit_fault, Guard::cannot_step, State::sit},
    {State::stand, Condition::sit_fault, Guard::at_rest, State::sit},
    {State::stand, Condition::lost_stance, Guard::ramping, State::ready},
    {State::stand, Condition::shut_down, Guard::rising, State::ready},
    {State::stand, Condition::request_off, Guard::rising, State::ready},
    {State::stand, Condition::request_sit, Guard::rising, State::ready},
    {State::stand, Condition::shut_down, Guard::at_rest, State::sit},
    {State::stand, Condition::request_off, Guard::at_rest, State::sit},
    {State::stand, Condition::request_sit, Guard::at_rest, State::sit},
    {State::stand, Condition::request_step, Guard::ramp_done, State::step},
    {State::stand, Condition::request_walk, Guard::ramp_done, State::walk},

    {State::step, Condition::request_cut, Guard::always, State::off},
    {State::step, Condition::damp_fault, Guard::always, State::fault},
    {State::step, Condition::sit_fault, Guard::cannot_step, State::sit},
    {State::step, Condition::sit_fault, Guard::slowed_down, State::stand},
    {State::step, Condition::shut_down, Guard::slowed_down, State::stand},
    {State::step, Condition::slow_fault, Guard::slowed_down, State::stand},
    {State::step, Condition::request_stand, Guard::slowed_down, State::stand},
    {State::step, Condition::request_sit, Guard::slowed_down, State::stand},
    {State::step, Condition::request_off, Guard::slowed_down, State::stand},
    {State::step, Condition::request_walk, Guard::always, State::walk},

    {State::walk, Condition::request_cut, Guard::always, State::off},
    {State::walk, Condition::damp_fault, Guard::always, State::fault},
    {State::walk, Condition::sit_fault, Guard::cannot_step, State::sit},
    {State::walk, Condition::sit_fault, Guard::always, State::step},
    {State::walk, Condition::shut_down, Guard::always, State::step},
    {State::walk, Condition::slow_fault, Guard::always, State::step},
    {State::walk, Condition::request_stand, Guard::always, State::step},
    {State::walk, Condition::request_step, Guard::always, State::step},
    {State::walk, Condition::request_sit, Guard::always, State::step},
    {State::walk, Condition::request_off, Guard::always, State::step},

    {State::sit, Condition::request_cut, Guard::always, State::off},
    {State::sit, Condition::damp_fault, Guard::always, State::fault},
    {State::sit, Condition::sit_done, Guard::fault_latched, State::fault},
    {State::sit, Condition::sit_done, Guard::none_latched, State::ready},

    {State::fault, Condition::request_cut, Guard::always, State::off},
    {State::fault, Condition::shut_down, Guard::damped, State::off},
    {State::fault, Condition::request_off, Guard::damped, State::off},
    {State::fault, Condition::request_reset, Guard::causes_gone, State::idle},
});

}  // namespace stilt::supervisor
