#pragma once

#include "firmware/controller/messages.h"
#include "mpc_core/control/planner.h"

namespace stilt::controller {

/// One cycle of the planner: newest state in, plan out. Knows no thread and no clock. Fixed memory, cycle()
/// is real-time safe.
class PlannerCycle {
 public:
  /// Not real time: milliseconds.
  [[nodiscard]] control::ConfigureStatus configure(const model::RobotModel& robot,
                                                   const control::ControllerParameters& parameters) noexcept {
    return planner_.configure(robot, parameters);
  }

  /// From now on steps follow the gaits of the library, which outlives this object; see Planner::follow().
  void follow(const gait::GaitLibrary& library) noexcept { planner_.follow(&library); }

  /// Plans with these settings from the next cycle on.
  void tune(const PlannerTuning& tuning) noexcept {
    planner_.adopt(tuning.settings);
    tuning_ = tuning.number;
  }

  /// Number of the tuning in force; 0: what configure() was given.
  [[nodiscard]] std::uint32_t tuning() const noexcept { return tuning_; }

  /// Plans from the request into `plan`, which stays as it is when there is no usable result. A request of
  /// another session than the last forgets the past: the robot stands still from then on.
  /// @return  whether `plan` is new
  [[nodiscard]] bool cycle(const PlanningRequest& request, control::Plan& plan) noexcept;

  /// About the newest cycle; solve_ns is left to who has a clock.
  [[nodiscard]] const PlanningResult& result() const noexcept { return result_; }

  /// How the newest solve went.
  [[nodiscard]] const solver::SolveReport& report() const noexcept { return report_; }

 private:
  control::Planner planner_;
  PlanningResult result_;
  solver::SolveReport report_;
  std::uint32_t tuning_ = 0;
};

}  // namespace stilt::controller
