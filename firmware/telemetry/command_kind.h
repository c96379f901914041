#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace stilt::telemetry {

/// What a Command asks for. `value` and `key` as said here, otherwise unused.
enum class CommandKind : std::uint8_t {
  heartbeat,  ///< sign of life of the commander; at least every supervisor.heartbeat_timeout_s / 2
  prepare,    ///< bring the motor drivers up
  stand,      ///< stand up (bringing the drivers up first), or come to a stand
  step,       ///< step in place
  walk,       ///< value: forward speed, m/s
  sit,        ///< come to a stand, sit down, damp the joints
  stop,       ///< stand still now and drop what was asked for; of anyone with the token, even out of command
  reset,      ///< clear faults whose causes are gone
  speed,      ///< value: forward speed of the walk that is on, m/s
  height,     ///< value: height of the hip, m
  tunable,    ///< key: section.key of a live tunable; value: its new value
  off,        ///< sit down, disable the drivers, end stiltd
  release,    ///< the commander gives up the command and needs no heartbeat
  cut,        ///< motors off at once, end stiltd: a robot on its feet falls; of anyone with the token
};
inline constexpr std::size_t kCommandKinds = 14;

/// A number that is no kind is "unknown".
[[nodiscard]] constexpr const char* name(CommandKind kind) noexcept {
  constexpr std::array<const char*, kCommandKinds> kNames = {
      "heartbeat", "prepare", "stand",  "step",    "walk", "sit",     "stop",
      "reset",     "speed",   "height", "tunable", "off",  "release", "cut"};
  const auto number = static_cast<std::size_t>(kind);
  return number < kNames.size() ? kNames[number] : "unknown";
}

/// Taken from every sender with the token, also out of command.
[[nodiscard]] constexpr bool is_of_everybody(CommandKind kind) noexcept {
  return kind == CommandKind::stop || kind == CommandKind::cut;
}

/// Taken from the commander alone while there is one.
[[nodiscard]] constexpr bool is_order(CommandKind kind) noexcept {
  return kind != CommandKind::heartbeat && kind != CommandKind::release && !is_of_everybody(kind);
}

/// An order of motion: its sender is the commander from then on. A height or a tunable makes none.
[[nodiscard]] constexpr bool makes_commander(CommandKind kind) noexcept {
  return is_order(kind) && kind != CommandKind::height && kind != CommandKind::tunable;
}

}  // namespace stilt::telemetry
