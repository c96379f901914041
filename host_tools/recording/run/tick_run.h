#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "firmware/control_loop/tick_record.h"
#include "host_tools/recording/run/plan_track.h"
#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/closed_loop/step_detector.h"
#include "host_tools/simulation/plant/stance.h"
#include "mpc_core/model/robot.h"

namespace stilt::record {

/// What a file does not hold.
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Ends a sentence about ticks that are missing.
inline constexpr const char* kBreakInPlots = "; plots have a break there";

/// Makes a run of ticks of stiltd: samples and summary. What only a simulation has is NaN, and so is the
/// place of the hip while the robot is off its feet. Steps are not known after a walk without foot
/// forces and plan, or without ticks for as long as a short swing.
class TickRun {
 public:
  /// @param robot     whose legs they are
  /// @param start_ns  clock of the ticks at time 0
  /// @param plans     those of the run; outlives this
  TickRun(const model::RobotConstants& robot, std::int64_t start_ns, const PlanTrack& plans,
          log::RunRecord& run);

  /// The next tick.
  void add(const control_loop::TickRecord& tick);

  /// Call after the last tick: writes the summary.
  void finish();

 private:
  [[nodiscard]] log::RunSample sample_of(double time_s, const control_loop::TickRecord& tick,
                                         const std::optional<PlanTrack::Point>& plan) const;
  void note_break(double time_s, const control_loop::TickRecord& tick);
  void note(double time_s, const control_loop::TickRecord& tick, const log::RunSample& sample);

  simulation::LegLengths leg_;
  std::int64_t start_ns_;
  const PlanTrack& plans_;
  log::RunRecord& run_;
  simulation::StepDetector steps_;
  supervisor::State last_state_ = supervisor::State::boot;
  bool begun_ = false;
  std::uint64_t last_tick_ = 0;
  std::uint32_t episode_ = 0;  ///< stance episode of the last tick
  double first_s_ = 0.0, last_s_ = 0.0;
  double last_x_m_ = 0.0;
  std::optional<double> distance_m_;
  double walked_m_ = 0.0, walked_s_ = 0.0;
};

/// Writes the steps into a summary, with the shortest and the longest.
void summarise_steps(const std::vector<log::Step>& steps, log::RunSummary& summary);

}  // namespace stilt::record
