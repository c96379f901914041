#pragma once

#include <cstdint>

#include "firmware/control_loop/mailboxes.h"
#include "mpc_core/dispatch/dispatched_planner.h"

namespace stilt::control_loop {

/// The planner at the mailboxes: newest request and tunables in, plan and records out. Depends on no thread
/// and no clock: real time, lock-step, simulation and replay run the same cycles. Fixed memory, real-time
/// safe but for configure().
class PlannerTask {
 public:
  /// Previews of plans for drawing, at most so many per second.
  static constexpr double kPreviewRate_hz = 30.0;
  static constexpr double kPreviewSpacing_s = 0.03;

  /// Not real time: milliseconds.
  [[nodiscard]] control::ConfigureStatus configure(const model::RobotModel& robot,
                                                   const control::ControllerParameters& parameters) noexcept {
    return planner_.configure(robot, parameters);
  }

  /// From now on steps follow the gaits of the library, which outlives this object; see
  /// PlannerInterface::follow().
  void follow(const gait::GaitLibrary& library) noexcept { planner_.planner().follow(&library); }

  /// Plans with these settings from the next cycle on.
  void tune(const PlannerTuning& tuning) noexcept {
    planner_.planner().adopt(tuning.settings);
    tuning_ = tuning.number;
  }

  /// Drops every cycle: the next one is the first of its stance episode.
  void restart() noexcept {
    result_ = {};
    previewed_s_ = -1.0;
  }

  /// Number of the active tuning; 0: what configure() was given.
  [[nodiscard]] std::uint32_t tuning() const noexcept { return tuning_; }

  /// One cycle: plans from the request into `plan`, which stays as it is when there is no usable result. A
  /// request of another stance episode than the last drops the past: the robot stands still from then on.
  /// @return  whether `plan` is new
  [[nodiscard]] bool cycle(const PlanningRequest& request, control::Plan& plan) noexcept;

  /// Takes new tunables, then one cycle into mail.plans.writer(), which the caller publishes when it is time
  /// to.
  [[nodiscard]] bool plan(const PlanningRequest& request, Mailboxes& mail) noexcept {
    if (mail.planner_tunings.has_news()) tune(mail.planner_tunings.newest());
    return cycle(request, mail.plans.writer());
  }

  /// Records the cycle of a request for a plan, before the plan is published.
  /// @param fresh     returned by plan()
  /// @param solve_ns  duration; 0 in lock-step
  void record(const PlanningRequest& request, bool fresh, std::int64_t solve_ns, Mailboxes& mail) noexcept;

  /// About the newest cycle; solve_ns is left to the caller, which has a clock.
  [[nodiscard]] const PlanningResult& result() const noexcept { return result_; }

  /// Of the newest solve.
  [[nodiscard]] const sqp::SolveReport& report() const noexcept { return report_; }

  [[nodiscard]] dispatch::DispatchedPlanner& planner() noexcept { return planner_; }

 private:
  dispatch::DispatchedPlanner planner_;
  PlanningResult result_;
  sqp::SolveReport report_;
  std::uint32_t tuning_ = 0;
  double previewed_s_ = -1.0;  ///< start of the newest preview
};

}  // namespace stilt::control_loop
