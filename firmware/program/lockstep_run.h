#pragma once

#include <cstddef>

#include "firmware/program/controller_state.h"
#include "firmware/program/outcome.h"
#include "firmware/program/realtime_run.h"

namespace stilt::program {

/// Runs the controller in turns with a simulated robot, on a virtual clock. Torque loop and planner run one
/// after the other on this thread; plans are in use plan_delay_s after the state they start from. Two runs
/// are identical bit for bit.
void run_lockstep(const Options& options, std::size_t bus_count, ControllerState& state, Outcome& outcome);

}  // namespace stilt::program
