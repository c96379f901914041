#pragma once

#include "firmware/configuration/hardware.h"
#include "firmware/configuration/runtime.h"
#include "firmware/configuration/telemetry.h"
#include "firmware/supervisor/parameters.h"
#include "mpc_core/control/parameters.h"

namespace stilt::configuration {

/// What the planner's cost pulls to.
enum class ReferenceKind {
  heuristic,  ///< a walk made up from speed, step time and height
  hzd,        ///< the gaits of the robot's library
};

/// What the controller follows.
struct ControllerChoice {
  ReferenceKind reference = ReferenceKind::heuristic;
};

/// Everything a configuration file sets. The parameters of the controller alone matter to the simulation.
/// Beside them stands what only the program on the robot needs.
struct Configuration : control::ControllerParameters {
  ControllerChoice controller;
  HardwareParameters hardware;
  supervisor::SupervisorParameters supervisor;
  RuntimeParameters runtime;
  TelemetryParameters telemetry;
};

}  // namespace stilt::configuration
