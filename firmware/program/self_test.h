#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/diagnostics/histogram.h"
#include "firmware/program/controller_state.h"
#include "firmware/program/options.h"
#include "firmware/realtime/processor_state.h"

namespace stilt::program {

/// What is asked of robot and computer.
struct SelfTestLimits {
  double answered_share = 0.999;       ///< runtime.self_test_answered_share
  double in_time_share = 0.99;         ///< runtime.self_test_in_time_share
  double late_share = 0.001;           ///< runtime.self_test_late_share
  double wakeup_latency_max_s = 5e-4;  ///< supervisor.torque_loop_overrun_s
  std::uint32_t missed_damp = 10;      ///< supervisor.missed_damp_ticks
  double plan_period_s = 0.01;         ///< 1 / timing.plan_rate_hz
  int planner_priority = 60;           ///< runtime.planner_priority
  bool accept_missing_stop = false;    ///< --accept-missing-stop
  bool hangs = false;                  ///< --hanging
};

/// One thing that was looked at.
struct Check {
  std::string name;
  bool passed = false;
  std::string measured;
  std::string limit;  ///< what would be right
};

/// What drivers, sensors and computer did.
struct SelfTestResult {
  SelfTestLimits limits;
  std::string failure;  ///< why the test could not be done; empty: it was
  std::string stopped;  ///< when, of which time; empty: it was not
  long long ticks = 0;
  std::array<long long, hal::kJoints> commands{};  ///< that left; others found the one before still waiting
  std::array<long long, hal::kJoints> answered{};  ///< replies in all
  std::array<long long, hal::kJoints> in_time{};   ///< ticks in which the reply to the tick before was there
  std::array<hal::DriverFault, hal::kJoints> fault{};  ///< the first that each driver reported
  std::array<std::uint32_t, hal::kJoints> fault_code{};
  std::array<std::uint32_t, hal::kJoints> missed{};  ///< most missed replies in a row
  long long base_readings = 0;                       ///< new pitches
  std::uint32_t base_missed = 0;                     ///< most in a row, of pitch or rate
  bool emergency_stop_pressed = false;
  bool emergency_stop_silent = false;
  std::string limit_trouble;  ///< the first temperature or supply beyond its limit; empty: none
  std::string bus_trouble;    ///< the first bus that was gone or off; empty: none
  hal::RobotReadings last;    ///< newest of all joints and of the torso
  long long bus_errors = 0;
  long long late_ticks = 0;  ///< later than limits.wakeup_latency_max_s
  diagnostics::Histogram wakeup_latency;
  diagnostics::Histogram round_trip;
  bool lockstep = false;                    ///< nothing is reported of the computer
  diagnostics::Histogram solve;             ///< of the planner at work beside; empty in lock-step
  long long failed_solves = 0;              ///< of these, without a usable plan
  double planner_s = 0;                     ///< how long the planner was at work
  std::optional<realtime::IdleState> idle;  ///< the slowest to leave
  std::optional<double> idle_held_us;       ///< slower ones are not used as long as the program runs
  std::vector<realtime::InterruptThread> interrupts;  ///< of the buses, that a solve may delay
  std::vector<std::string> interrupt_sentences;       ///< of each bus with an adapter
  std::optional<long long> throttled;                 ///< times a processor was slowed down during the test

  /// Of the readings of the newest tick. What was missed before the test does not count: a driver that is up
  /// is not commanded while others are brought up.
  void keep_most_missed(const hal::RobotReadings& readings) noexcept;
  /// Every joint answered enough of its commands. A machine that is late itself withholds commands and reads
  /// replies late, which is no fault of the drivers. They must answer what left, sooner or later.
  [[nodiscard]] bool answered_enough() const noexcept;
  /// And enough of all commands in time: together with the machine they are fit to be driven.
  [[nodiscard]] bool in_time_enough() const noexcept;
  /// Everything that was looked at; nothing when the test could not be done.
  [[nodiscard]] std::vector<Check> checks() const;
  [[nodiscard]] bool passed() const;
};

/// Brings all drivers up, commands zero torque at the rate of the torque loop for options.self_test_s, then
/// disables them. The planner is at work on its own thread. Nothing moves. In lock-step, a tick is a turn
/// of the simulated robot, and nothing is reported of the computer.
/// @param idle_held  the kernel keeps to idle states of runtime.idle_exit_max_s
[[nodiscard]] SelfTestResult run_self_test(const Options& options, ControllerState& state,
                                           const std::atomic<bool>& stop, bool idle_held);

/// The results for people, and as JSON.
[[nodiscard]] std::string to_text(const SelfTestResult& result);
[[nodiscard]] std::string to_json(const SelfTestResult& result);

}  // namespace stilt::program
