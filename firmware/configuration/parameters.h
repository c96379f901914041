#pragma once

#include "firmware/configuration/hardware.h"
#include "firmware/configuration/runtime.h"
#include "firmware/configuration/telemetry.h"
#include "firmware/supervisor/parameters.h"
#include "mpc_core/control/parameters.h"

namespace stilt::configuration {

/// Everything a configuration file sets: the parameters of the controller, which alone matter to the
/// simulation, and beside them what only the program on the robot needs.
struct Configuration : control::ControllerParameters {
  HardwareParameters hardware;
  supervisor::SupervisorParameters supervisor;
  RuntimeParameters runtime;
  TelemetryParameters telemetry;
};

}  // namespace stilt::configuration
