#pragma once

#include "firmware/program/controller_state.h"
#include "firmware/program/outcome.h"

namespace stilt::program {

/// Runs the controller on the clock: torque loop and planner on threads of their own, everything ordinary on
/// this one. Returns when the supervisor is off.
void run_realtime(const Options& options, Signals& signals, ControllerState& state, Outcome& outcome);

}  // namespace stilt::program
