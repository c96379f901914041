#pragma once

#include <atomic>
#include <expected>
#include <functional>
#include <string>

#include "firmware/program/controller_state.h"
#include "firmware/program/options.h"
#include "firmware/program/terminal_person.h"

namespace stilt::program {

/// How a commissioning command ended.
struct CommissioningOutcome {
  std::string error;       ///< why it could not do its work, or write what it found; empty: it did
  bool bad_input = false;  ///< the error is about what the user gave
  bool passed = false;     ///< everything that was checked passes
  std::string text;        ///< for people, when the JSON does not go to standard output
  std::string json;        ///< empty: written already, or there is none
};

/// A line of JSON with the reason for which a command could not do its work.
[[nodiscard]] std::string failure_json(const std::string& error);

/// scan, watch, jog, zero, calibrate or identify, over open buses. Shows on standard output while it works.
/// @param person  answers what jog and calibrate ask
[[nodiscard]] CommissioningOutcome run_commissioning(const Options& options, ControllerState& state,
                                                     const std::atomic<bool>& stop, TerminalPerson& person);

/// Does work with the clock of a run: on a thread with the torque loop's priority, or in lock-step with the
/// simulated robot. The error says why it was not done.
[[nodiscard]] std::expected<void, std::string> run_with_clock(const Options& options, ControllerState& state,
                                                              const std::function<void(hal::Clock&)>& work);

}  // namespace stilt::program
