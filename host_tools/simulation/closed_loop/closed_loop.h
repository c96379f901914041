#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <vector>

#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/closed_loop/fault_plan.h"
#include "host_tools/simulation/closed_loop/scenario.h"
#include "host_tools/simulation/closed_loop/simulated_controller.h"
#include "host_tools/simulation/plant/plant.h"
#include "host_tools/simulation/plant/stance.h"

namespace stilt::simulation {

/// Observes a run. Has no effect on it, except through `plans`.
struct RunObserver {
  /// Called just before each of the planner's turns; false skips the turn. The first plan is always made.
  std::function<bool(double time_s)> plans = [](double) { return true; };
  std::function<void(const control_loop::PlanningRequest&, const sqp::SolveReport&)> planned =
      [](const control_loop::PlanningRequest&, const sqp::SolveReport&) {};
  std::function<void(const control_loop::TickRecord&)> ticked = [](const control_loop::TickRecord&) {};
};

/// Settings of one run of the simulated robot under its controller.
struct RunSettings {
  double duration_s = 10.0;
  model::StateVector initial_state = model::StateVector::Zero();
  LegLengths leg;                      ///< for drawing the feet of a plan
  std::vector<TimedCommand> commands;  ///< in order of time
  std::vector<Push> pushes;
  std::vector<TimedFault> faults;                                    ///< faults without buses
  double planner_until_s = std::numeric_limits<double>::infinity();  ///< then the planner stops
  double measure_from_s = 0.0;  ///< slip and time at the torque limit count from this time
  bool use_true_state = false;  ///< the controller gets the plant's state instead of estimating it
  bool keep_samples = true;     ///< false: summary and solves only
  double sample_rate_hz = 200.0;
  std::function<void(double time_s)> progress = [](double) {};  ///< called once per simulated second
  const std::atomic<bool>* stop = nullptr;                      ///< true ends the run early; may be left null
  RunObserver observer;
};

/// Runs until the duration is over, the robot falls or `stop` is true. The robot begins on its feet, and the
/// first plan is active in the first tick. Each later plan starts from the state of its tick and becomes
/// active plan_delay_s later. Solve times are measured by the wall clock and have no effect. The record has
/// no command line and no drawing.
[[nodiscard]] log::RunRecord run_closed_loop(Plant& plant, SimulatedController& controller,
                                             const RunSettings& settings);

}  // namespace stilt::simulation
