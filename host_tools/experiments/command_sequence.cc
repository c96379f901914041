#include "host_tools/experiments/command_sequence.h"

#include <random>

#include "host_tools/experiments/portable_random.h"

namespace stilt::experiments {

std::vector<simulation::TimedCommand> random_commands(std::uint32_t seed, double duration_s) {
  constexpr gait::GaitKind kKinds[] = {gait::GaitKind::stand, gait::GaitKind::step, gait::GaitKind::walk};
  std::mt19937 random(seed);
  std::vector<simulation::TimedCommand> commands;
  for (double time_s = 0.0; time_s < duration_s; time_s += between(random, 3.0, 8.0)) {
    const gait::GaitKind kind = kKinds[random() % 3];
    commands.push_back({time_s, {kind, kind == gait::GaitKind::walk ? between(random, -0.4, 0.8) : 0.0}});
  }
  return commands;
}

}  // namespace stilt::experiments
