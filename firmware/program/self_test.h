#pragma once

#include <array>
#include <atomic>
#include <string>

#include "firmware/diagnostics/histogram.h"
#include "firmware/program/controller_state.h"
#include "firmware/program/options.h"

namespace stilt::program {

/// What the drivers and sensors answered.
struct SelfTestResult {
  std::string failure;  ///< why the test could not be done; empty: it was
  long long ticks = 0;
  std::array<long long, hal::kJoints> commands{};  ///< that left; others found the one before still waiting
  std::array<long long, hal::kJoints> answered{};  ///< replies in all
  std::array<long long, hal::kJoints> in_time{};   ///< ticks in which the reply to the tick before was there
  long long base_readings = 0;
  hal::RobotReadings last;  ///< newest of all joints and of the torso
  long long bus_errors = 0;
  diagnostics::Histogram wakeup_latency;
  diagnostics::Histogram round_trip;

  double enough_answered = 0.999;  ///< runtime.self_test_answered_share
  double enough_in_time = 0.99;    ///< runtime.self_test_in_time_share

  /// Every joint answered enough of its commands. A machine that is late itself withholds commands and reads
  /// replies late, which is no fault of the drivers: they must answer what left, sooner or later.
  [[nodiscard]] bool answered_enough() const noexcept;
  /// And enough of all commands in time: together with the machine they are fit to be driven.
  [[nodiscard]] bool in_time_enough() const noexcept;
  [[nodiscard]] bool passed() const noexcept { return answered_enough() && in_time_enough(); }
};

/// Brings all drivers up and commands zero torque at the rate of the torque loop for options.self_test_s,
/// then disables the drivers. Nothing moves. In lock-step a tick is a turn of the simulated robot.
[[nodiscard]] SelfTestResult run_self_test(const Options& options, ControllerState& state,
                                           const std::atomic<bool>& stop);

/// The figures for people, and as JSON.
[[nodiscard]] std::string to_text(const SelfTestResult& result);
[[nodiscard]] std::string to_json(const SelfTestResult& result);

}  // namespace stilt::program
