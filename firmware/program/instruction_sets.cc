#include "firmware/program/instruction_sets.h"

#include "mpc_core/dispatch/dispatched_planner.h"

namespace stilt::program {
namespace {

using model::InstructionSet;

std::string available_names() {
  std::string names;
  for (const InstructionSet set :
       {InstructionSet::avx512, InstructionSet::avx2, InstructionSet::sse2, InstructionSet::neon}) {
    if (!dispatch::available(set)) continue;
    if (!names.empty()) names += ", ";
    names += model::name_of(set);
  }
  return names;
}

}  // namespace

std::string planner_instruction_sets() { return "planner for " + available_names(); }

void choose_instruction_set(configuration::Configuration& configuration) {
  InstructionSet& set = configuration.sqp.instruction_set;
  if (set == InstructionSet::automatic) set = *dispatch::choose(set);
}

std::string no_such_instructions(const control::ControllerParameters& parameters) {
  return "sqp.instruction_set is " + std::string(model::name_of(parameters.sqp.instruction_set)) +
         ", which this program or this processor lacks; here the planner can use " + available_names();
}

}  // namespace stilt::program
