#pragma once

#include <optional>
#include <vector>

#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/closed_loop/scenario.h"
#include "host_tools/simulation/closed_loop/step_detector.h"
#include "host_tools/simulation/plant/plant.h"

namespace stilt::robot_on_bus {

/// What the plant shows of a walk, as `stilt sim` reports it: from the moment the gantry has released the
/// robot until the robot falls, sits down or the run ends. Nothing of the controller: plans and estimates are
/// not known here, nor when it was to stop. The mean speed therefore counts, after the first 3 s, until
/// the robot is within 0.1 m of where it ends.
class WalkRecorder {
 public:
  /// @param keep_samples  record 200 samples per second for the report
  explicit WalkRecorder(bool keep_samples) : keep_samples_(keep_samples) {}

  void begin(const simulation::Plant& plant);
  /// After each step of the plant.
  void observe_step(const simulation::Plant& plant);
  /// After each tick.
  void observe_tick(double time_s, const simulation::Plant& plant, const simulation::ActingPush& push);
  /// The first call counts.
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

  std::vector<Place> way_;  ///< after the first 3 s, of the hip
};

}  // namespace stilt::robot_on_bus
