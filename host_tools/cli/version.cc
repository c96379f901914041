#include "host_tools/cli/version.h"

#include "firmware/program/instruction_sets.h"
#include "firmware/version/commit.h"
#include "firmware/version/megabytes.h"
#include "host_tools/simulation/closed_loop/simulated_controller.h"

namespace stilt::cli {

std::string version_text() {
  return "stilt " STILT_VERSION "\ncommit            " + std::string(version::commit()) +
         "\ncompiler          GCC " __VERSION__ "\ninstruction set   " STILT_ISA ", " +
         program::planner_instruction_sets() + "\ncontroller object " +
         version::megabytes(simulation::SimulatedController::bytes());
}

}  // namespace stilt::cli
