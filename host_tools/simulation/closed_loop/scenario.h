#pragma once

#include <string_view>
#include <vector>

#include "host_tools/simulation/plant/plant.h"
#include "mpc_core/gait/command.h"

/// Events of a run: commands of the operator and pushes on the robot.
namespace stilt::simulation {

/// A horizontal force on the torso for a time; positive is forward.
struct Push {
  double force_N = 0.0;
  double start_s = 0.0;
  double duration_s = 0.0;
  PushPoint point = PushPoint::hip;
};

/// A command with its time.
struct TimedCommand {
  double start_s = 0.0;
  gait::GaitCommand command;
};

/// Total force and point of the pushes that are active at one time; overlapping pushes at one point add up.
struct ActingPush {
  double force_N = 0.0;
  PushPoint point = PushPoint::hip;
};

/// Parses N@START+DURATION[@hip|torso]. Throws std::invalid_argument, one sentence, for any other text.
[[nodiscard]] Push parse_push(std::string_view text);

/// Parses GAIT[:SPEED]@START. Throws std::invalid_argument, one sentence, for any other text.
/// @param usual_speed_m_s  of a command without SPEED
[[nodiscard]] TimedCommand parse_timed_command(std::string_view text, double usual_speed_m_s);

/// Parses stand, step or walk. Throws std::invalid_argument, one sentence, for any other text.
[[nodiscard]] gait::GaitKind parse_gait(std::string_view text);

/// The text of a gait for parse_gait().
[[nodiscard]] const char* gait_name(gait::GaitKind kind);

/// Whether the controller gets the plant's state but for the velocity of the base: "truth" instead of
/// "estimated". Throws std::invalid_argument, one sentence, for any other text.
[[nodiscard]] bool parse_knows_truth(std::string_view text);

/// Throws std::invalid_argument when pushes at different points overlap in time. So it does when one is
/// shorter than a tick, which could lie between two ticks and never act.
void check_pushes(const std::vector<Push>& pushes, double tick_s);

/// The push of a tick that begins at `time_s`. A push acts through whole ticks, those that begin within it.
[[nodiscard]] ActingPush push_at(const std::vector<Push>& pushes, double time_s);

/// The last command given by that time; standing before the first. `commands` must be in order of time.
[[nodiscard]] gait::GaitCommand command_at(const std::vector<TimedCommand>& commands, double time_s);

}  // namespace stilt::simulation
