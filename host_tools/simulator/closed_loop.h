#pragma once

#include <functional>
#include <vector>

#include "host_tools/log/run_record.h"
#include "host_tools/simulator/controller.h"
#include "host_tools/simulator/plant.h"
#include "host_tools/simulator/scenario.h"
#include "host_tools/simulator/stance.h"
#include "mpc_core/control/parameters.h"

namespace stilt::simulator {

/// One run of the simulated robot under a controller.
struct RunSettings {
  double duration_s = 10.0;
  model::StateVector initial_state = model::StateVector::Zero();
  LegLengths leg;                      ///< to draw the feet of a plan
  std::vector<TimedCommand> commands;  ///< in order of time
  std::vector<Push> pushes;
  double measure_from_s = 0.0;  ///< slip and time at the torque limit count from here
  bool use_true_state = false;  ///< the controller is given the plant's state instead of estimating it
  control::TimingParameters timing;
  bool keep_samples = true;                                     ///< false: summary and solves only
  std::function<void(double time_s)> progress = [](double) {};  ///< called once a simulated second
};

/// Times of the fixed schedule, in ticks of the torque loop. Everything happens at a tick; nothing depends on
/// the wall clock.
struct TickSchedule {
  double tick_s = 0.001;
  int plan_period_ticks = 10;
  int plan_delay_ticks = 5;

  /// Rounded to whole ticks, the delay to at least one: a plan comes into use at a tick after the one it
  /// starts from. The planner starts a new plan only when the last one has arrived.
  explicit TickSchedule(const control::TimingParameters& timing);
};

/// Longest time step, at most the wished one, that divides the tick.
[[nodiscard]] double time_step_for_tick(double wished_s, double tick_s);

/// Runs until the duration is over or the robot falls. The first plan is there when the run begins; each
/// later one starts from the state of its tick and comes into use plan_delay_s later. Solve times are
/// measured around plan() and influence nothing. The record has no command line and no drawing.
[[nodiscard]] log::RunRecord run_closed_loop(Plant& plant, Controller& controller,
                                             const RunSettings& settings);

}  // namespace stilt::simulator
