#pragma once

#include <vector>

#include "firmware/configuration/consistency.h"
#include "firmware/configuration/hardware.h"
#include "firmware/configuration/runtime.h"
#include "firmware/supervisor/parameters.h"

namespace stilt::configuration {

/// Contradictions of the wiring: joints on buses that do not exist, drivers that share an identifier,
/// identifiers their protocol does not have, no sensor of the pitch.
void check_hardware(const HardwareParameters& hardware, std::vector<Contradiction>& found);

/// Contradictions between thresholds of the supervisor: each mild reaction must come before the hard one.
void check_supervisor(const supervisor::SupervisorParameters& supervisor, std::vector<Contradiction>& found);

/// Contradictions between the threads.
void check_runtime(const RuntimeParameters& runtime, std::vector<Contradiction>& found);

}  // namespace stilt::configuration
