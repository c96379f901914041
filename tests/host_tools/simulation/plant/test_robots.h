#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "firmware/robots/robots.h"
#include "host_tools/simulation/closed_loop/simulated_controller.h"
#include "host_tools/simulation/plant/plant.h"
#include "host_tools/simulation/plant/simulated_robot.h"
#include "host_tools/simulation/plant/stance.h"
#include "mpc_core/model/robot.h"
#include "tests/robots.h"

/// Robots and controllers that several tests of the simulator use.
namespace stilt::simulation {

inline constexpr LegLengths kAmberLeg{0.4064, 0.4667};
inline constexpr double kHipHeight_m = 0.8;

inline const codegen::PlanarTree& robot_tree(std::string_view name) {
  return robots::find(name).value()->tree;
}

inline Plant amber_plant(const PlantOptions& options = {}, std::uint64_t seed = 1) {
  return Plant(make_plant_model(robot_tree("amber3m"), options, kHipHeight_m), options, seed);
}

/// In the air, every velocity different from zero.
inline model::StateVector tumbling() {
  model::StateVector state = standing_state(kAmberLeg, kHipHeight_m, 0.15);
  state[1] = 5.0;
  state.tail<7>() << 0.5, 1.0, 0.7, -1.0, 2.0, 1.5, -0.5;
  return state;
}

/// Steps with the joints held by a stiff spring and damper.
inline void hold(Plant& plant, const model::StateVector& posture, double duration_s) {
  for (int i = 0; i < std::lround(duration_s / plant.time_step_s()); ++i) {
    const model::StateVector state = plant.state();
    plant.command_torque(800.0 * (posture - state).segment<4>(3) - 40.0 * state.tail<4>());
    plant.step();
  }
}

/// The controller of AMBER-3M with default parameters, without gaits.
inline std::unique_ptr<SimulatedController> amber_controller(const ControllerSetup& changes = {}) {
  ControllerSetup setup = changes;
  setup.robot = &testing_support::amber3m();
  auto controller = std::make_unique<SimulatedController>();
  EXPECT_EQ(controller->configure(setup), control::ConfigureStatus::ok);
  return controller;
}

}  // namespace stilt::simulation
