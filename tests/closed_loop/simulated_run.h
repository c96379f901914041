#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "host_tools/simulation/closed_loop/closed_loop.h"
#include "host_tools/simulation/plant/plant.h"
#include "mpc_core/control/parameters.h"
#include "mpc_core/model/robot.h"

/// Runs of the simulated robot as `stilt sim` makes them: shipped configuration and gaits, sensors only.
namespace stilt::testing_support {

/// What a run changes of the shipped configuration and of the nominal world.
struct RunRequest {
  std::string robot = "amber3m";
  std::string preset = {};  ///< shipped changes of the controller's configuration; empty: none
  double horizon_s = 1.0;
  std::vector<std::string> settings = {};  ///< "section.key=value" of the controller's configuration
  std::vector<std::string> plant = {};     ///< "key=value" of the simulated robot
  std::vector<simulation::TimedCommand> commands = {};
  std::vector<simulation::Push> pushes = {};
  double duration_s = 20.0;
  std::uint64_t seed = 1;
  bool use_true_state = false;
  bool keep_samples = false;
  bool follow_gaits = false;  ///< the shipped ones are the planner's reference
};

/// Shipped configuration of the request's robot with the request's changes.
[[nodiscard]] configuration::Configuration parameters_of(const RunRequest& request);

/// Plant, controller and settings, ready to run. Throws std::runtime_error when the request is mistaken.
struct SimulatedRun {
  explicit SimulatedRun(const RunRequest& request);

  /// The whole run under the controller of the robot.
  [[nodiscard]] log::RunRecord run() { return simulation::run_closed_loop(plant, *controller, settings); }

  const model::RobotModel& robot;
  configuration::Configuration parameters;
  std::unique_ptr<simulation::SimulatedController> controller;
  simulation::Plant plant;
  simulation::RunSettings settings;
};

/// Walking from time 0 on.
[[nodiscard]] RunRequest walking(double speed_m_s, double horizon_s, double duration_s);

/// How a run ended, for messages: survival, fall, speed, steps.
[[nodiscard]] std::string describe(const SimulatedRun& run, const log::RunRecord& record);

}  // namespace stilt::testing_support
