#pragma once

#include <cstdint>
#include <vector>

#include "host_tools/simulation/closed_loop/scenario.h"

namespace stilt::experiments {

/// A random sequence of commands from time 0 on: stand, step or walk with equal probability, walking at -0.4
/// to 0.8 m/s, each held for 3 to 8 s. The same seed gives the same sequence with every compiler.
[[nodiscard]] std::vector<simulation::TimedCommand> random_commands(std::uint32_t seed, double duration_s);

}  // namespace stilt::experiments
