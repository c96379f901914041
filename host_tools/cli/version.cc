#include "host_tools/cli/version.h"

#include "host_tools/simulator/mpc_controller.h"
#include "mpc_core/model/batch.h"

namespace stilt::cli {

std::string instruction_set() {
  return std::string(STILT_ISA) + ", " + std::to_string(model::kLanes) + " lanes";
}

std::string version_text() {
  return "stilt " STILT_VERSION "\ncompiler          GCC " __VERSION__ "\ninstruction set   " +
         instruction_set() + "\ncontroller object " + std::to_string(sizeof(simulator::MpcController)) +
         " bytes";
}

}  // namespace stilt::cli
