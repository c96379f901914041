#pragma once

#include <string_view>
#include <vector>

#include "host_tools/simulation/plant/plant.h"
#include "mpc_core/gait/command.h"

/// What happens during a run: what the operator asks for, and what pushes the robot.
namespace stilt::simulation {

/// A horizontal force on the torso over a time; positive is forward.
struct Push {
  double force_N = 0.0;
  double start_s = 0.0;
  double duration_s = 0.0;
  PushPoint point = PushPoint::hip;
};

/// A command, and when it is given.
struct TimedCommand {
  double start_s = 0.0;
  gait::GaitCommand command;
};

/// Force and point of the pushes acting at one time; pushes that overlap at one point add up.
struct ActingPush {
  double force_N = 0.0;
  PushPoint point = PushPoint::hip;
};

/// Throws std::invalid_argument, one sentence, unless the text is N@START+DURATION[@hip|torso].
[[nodiscard]] Push parse_push(std::string_view text);

/// Throws std::invalid_argument, one sentence, unless the text is GAIT[:SPEED]@START.
[[nodiscard]] TimedCommand parse_timed_command(std::string_view text);

/// Throws std::invalid_argument, one sentence, unless the text is stand, step or walk.
[[nodiscard]] gait::GaitKind parse_gait(std::string_view text);

/// Whether the controller knows the plant's state: "truth" rather than "estimated". Throws
/// std::invalid_argument, one sentence, for another text.
[[nodiscard]] bool parse_knows_truth(std::string_view text);

/// Throws std::invalid_argument when pushes at different points overlap in time.
void check_pushes(const std::vector<Push>& pushes);

[[nodiscard]] ActingPush push_at(const std::vector<Push>& pushes, double time_s);

/// The last command given by that time; standing before the first. Commands in order of time.
[[nodiscard]] gait::GaitCommand command_at(const std::vector<TimedCommand>& commands, double time_s);

}  // namespace stilt::simulation
