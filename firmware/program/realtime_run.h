#pragma once

#include <atomic>

#include "firmware/program/controller_state.h"
#include "firmware/program/outcome.h"

namespace stilt::program {

/// Runs the controller on the clock: torque loop and planner on threads of their own, everything ordinary on
/// this one. Returns when the supervisor is off.
/// @param print_asked  while it runs: print the histograms so far, once
void run_realtime(const Options& options, std::atomic<bool>& print_asked, ControllerState& state,
                  Outcome& outcome);

}  // namespace stilt::program
