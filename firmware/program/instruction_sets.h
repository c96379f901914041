#pragma once

#include <string>

#include "firmware/configuration/configuration.h"

namespace stilt::program {

/// "planner for avx512, avx2": what the planner of this program can use on this processor, the best first.
[[nodiscard]] std::string planner_instruction_sets();

/// Replaces an automatic sqp.instruction_set by what it stands for on this processor, so that a record names
/// it.
void choose_instruction_set(configuration::Configuration& configuration);

/// Why no planner was found: sqp.instruction_set is one that program or processor lacks.
[[nodiscard]] std::string no_such_instructions(const control::ControllerParameters& parameters);

}  // namespace stilt::program
