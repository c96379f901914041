#pragma once

#include <string>

#include "firmware/program/options.h"
#include "firmware/realtime/capability.h"

namespace stilt::program {

/// What a configuration means for the buses: a line per bus, and one where two cannot be distinguished.
/// Others name what their frames cannot carry, drivers without a watchdog, and poses that the robot cannot
/// take. `refused`: a bus is loaded beyond what works, or there is such a thing.
struct BusReport {
  std::string text;
  bool refused = false;
};
[[nodiscard]] BusReport report_buses(const configuration::Configuration& configuration);

/// The robot of a configuration as its URDF was read: a line of mass and lengths, one of the joints'
/// armatures. A third has the hip height of the configuration as a share of the straight leg, and a warning
/// where that is not usual.
[[nodiscard]] std::string robot_text(const configuration::Configuration& configuration);

/// Whether the machine must be real time to run this configuration.
[[nodiscard]] bool requires_realtime(const configuration::Configuration& configuration);

/// What the threads of a configuration ask of the machine.
[[nodiscard]] realtime::Requirements requirements_of(const configuration::RuntimeParameters& runtime);

/// Whether idle states are kept short: "kept short", or "as they are (Permission denied)".
[[nodiscard]] std::string idle_text(const realtime::Capability& capability);

/// The machine in a few lines: kernel, processors, governor, locked memory, priority, idle states, and
/// what is lacking.
[[nodiscard]] std::string describe(const realtime::Capability& capability);

}  // namespace stilt::program
