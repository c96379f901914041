#pragma once

#include <atomic>

#include "firmware/program/controller_state.h"
#include "firmware/program/outcome.h"

namespace stilt::program {

/// What people may ask of a run from outside, set by signal handlers.
struct Signals {
  std::atomic<bool> stop = false;              ///< sit, damp, disable the drivers, end
  std::atomic<bool> print_statistics = false;  ///< print the histograms so far
};

/// Runs the controller on the clock: torque loop and planner on threads of their own, everything ordinary on
/// this one. Returns when the supervisor is off.
void run_realtime(const Options& options, Signals& signals, ControllerState& state, Outcome& outcome);

}  // namespace stilt::program
