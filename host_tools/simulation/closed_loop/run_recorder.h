#pragma once

#include "host_tools/recording/mean_speed.h"
#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/closed_loop/closed_loop.h"
#include "host_tools/simulation/closed_loop/step_detector.h"
#include "host_tools/simulation/plant/plant.h"

namespace stilt::simulation {

/// Percentile by nearest rank: the smallest value that at least that share of all values does not exceed. 0
/// for an empty list.
[[nodiscard]] double percentile(std::vector<double> values, double share);

/// p50, p99 and maximum; zeros for an empty list.
[[nodiscard]] log::Percentiles percentiles(const std::vector<double>& values);

/// Observes a run and writes its record.
class RunRecorder {
 public:
  /// @param planned_friction  friction coefficient that the plans assume
  RunRecorder(const RunSettings& settings, const control_loop::PlanTiming& timing, double planned_friction,
              log::RunRecord& record);

  /// Call after each step of the plant.
  void observe_step(const Plant& plant);
  /// Call at each tick, after the controller's tick.
  /// @param active_plan  has no nodes when there is none
  void observe_tick(double time_s, const Plant& plant, const control_loop::TickRecord& tick,
                    const control::Plan& active_plan);
  /// Call after each plan of the planner.
  void observe_plan(const log::SolveSample& solve, const control::Plan& newest_plan);
  /// Call at the end: writes the summary.
  void finish(double time_s, const Plant& plant, long long heap_allocations);

 private:
  void take_sample(double time_s, const Plant& plant, const control_loop::TickRecord& tick,
                   const control::Plan& active_plan);
  void observe_plan_in_use(const control::Plan& plan);
  void take_snapshot(const control::Plan& plan);
  void summarise_solves();

  const RunSettings& settings_;
  log::RunRecord& record_;
  StepDetector steps_;
  double planned_friction_;
  double tick_s_;
  int ticks_per_sample_ = 5;
  int plans_per_snapshot_ = 5;
  long long ticks_ = 0;
  long long plans_ = 0;
  std::int64_t plan_in_use_ = -1;  ///< sequence of the newest plan that drove the robot
  double start_x_m_ = 0.0;
  log::MeanSpeed speed_;
  bool measuring_ = false;
  double slip_before_m_ = 0.0;  ///< slip before the measurement began
};

}  // namespace stilt::simulation
