#pragma once

#include <optional>
#include <vector>

#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/closed_loop/scenario.h"
#include "host_tools/simulation/closed_loop/step_detector.h"
#include "host_tools/simulation/plant/plant.h"

namespace stilt::robot_on_bus {

/// The plant's data of a walk, as in the report of `stilt sim`. They last from the release by the gantry
/// until the robot falls, sits down or the run ends. Data of the controller are not available: plans,
/// estimates, and the time of its stop command. The mean speed therefore counts from 3 s on, until the robot
/// is within 0.1 m of its final position.
class WalkRecorder {
 public:
  /// @param keep_samples record 200 samples per second for the report
  explicit WalkRecorder(bool keep_samples) : keep_samples_(keep_samples) {}

  void begin(const simulation::Plant& plant);
  /// Call after each step of the plant.
  void observe_step(const simulation::Plant& plant);
  /// Call after each tick.
  void observe_tick(double time_s, const simulation::Plant& plant, const simulation::ActingPush& push);
  /// Call at the end of the walk. Only the first call counts.
  void finish(double time_s, const simulation::Plant& plant, simulation::Fall fall);

  [[nodiscard]] bool running() const { return running_; }
  [[nodiscard]] bool finished() const { return finished_; }
  [[nodiscard]] simulation::Fall fall() const { return fall_; }
  [[nodiscard]] const log::RunRecord& record() const { return record_; }

 private:
  void take_sample(double time_s, const simulation::Plant& plant, const simulation::ActingPush& push);

  bool keep_samples_;
  bool running_ = false;
  bool finished_ = false;
  simulation::Fall fall_ = simulation::Fall::none;
  log::RunRecord record_;
  simulation::StepDetector steps_;
  long long ticks_ = 0;
  double start_x_m_ = 0.0;
  double start_slip_m_ = 0.0;
  struct Place {
    double time_s = 0.0, x_m = 0.0;
  };
  [[nodiscard]] double mean_speed_m_s(double time_s, double x_m) const;

  std::vector<Place> way_;  ///< positions of the hip after the first 3 s
};

}  // namespace stilt::robot_on_bus
