#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/diagnostics/histogram.h"
#include "firmware/program/controller_state.h"
#include "firmware/program/options.h"
#include "firmware/realtime/thread.h"

namespace stilt::program {

/// The planner at work without a robot, on a thread with its own priority and processor. It plans a walk at
/// 0.5 m/s that follows its own plans and begins anew, without an initial guess, once per second.
class PlannerLoad {
 public:
  /// @param state  its planner is configured, and belongs to this object between start() and end()
  PlannerLoad(const Options& options, ControllerState& state) : options_(options), state_(state) {}

  /// False: there is no thread.
  [[nodiscard]] bool start();
  void end();

  /// Durations of the solves, after end().
  [[nodiscard]] const diagnostics::Histogram& solve() const noexcept { return solve_; }
  /// How many of them gave no usable plan.
  [[nodiscard]] long long failed() const noexcept { return failed_; }
  /// From start() to end().
  [[nodiscard]] double duration_s() const noexcept;
  /// Time between two plans, s.
  [[nodiscard]] double period_s() const noexcept;

 private:
  static void run(void* load);
  void plan();

  const Options& options_;
  ControllerState& state_;
  realtime::Thread thread_;
  std::atomic<bool> end_ = false;
  diagnostics::Histogram solve_;
  long long failed_ = 0;
  std::int64_t started_ns_ = 0, ended_ns_ = 0;
};

}  // namespace stilt::program
