#pragma once

#include <atomic>
#include <cstddef>

#include "firmware/program/controller_state.h"
#include "firmware/program/outcome.h"

namespace stilt::program {

/// Runs the controller in turns with a simulated robot: a virtual clock, torque loop and planner one after
/// the other on this thread, plans in use plan_delay_s after the state they start from. Two runs are
/// identical bit for bit.
/// @param stop  set from outside to sit down and end
void run_lockstep(const Options& options, std::size_t bus_count, const std::atomic<bool>& stop,
                  ControllerState& state, Outcome& outcome);

}  // namespace stilt::program
