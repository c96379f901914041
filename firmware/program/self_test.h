#pragma once

#include <array>
#include <atomic>
#include <string>

#include "firmware/diagnostics/histogram.h"
#include "firmware/program/controller_state.h"
#include "firmware/program/options.h"

namespace stilt::program {

/// What the drivers and sensors answered.
struct SelfTestFigures {
  std::string failure;  ///< why the test could not be done; empty: it was
  long long ticks = 0;
  std::array<long long, hal::kJoints> replies{};
  long long base_readings = 0;
  long long bus_errors = 0;
  diagnostics::Histogram wakeup;
  diagnostics::Histogram round_trip;

  /// Every joint answered at least 99.9 % of the commands.
  [[nodiscard]] bool passed() const noexcept;
};

/// Brings all drivers up and commands zero torque at the rate of the torque loop for options.self_test_s,
/// then lets go. Nothing moves.
[[nodiscard]] SelfTestFigures run_self_test(const Options& options, ControllerState& state,
                                            const std::atomic<bool>& stop);

/// The figures for people, and as JSON.
[[nodiscard]] std::string to_text(const SelfTestFigures& figures);
[[nodiscard]] std::string to_json(const SelfTestFigures& figures);

}  // namespace stilt::program
