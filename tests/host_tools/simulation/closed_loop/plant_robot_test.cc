#include "host_tools/simulation/closed_loop/plant_robot.h"

#include <gtest/gtest.h>

#include "tests/host_tools/simulation/plant/test_robots.h"

namespace stilt::simulation {
namespace {

TEST(PlantRobot, AFrozenEncoderMisleadsItsDriver) {
  constexpr std::size_t kKnee = 1;
  constexpr double kKp_Nm_rad = 10.0, kAhead_rad = 0.2;
  Plant plant = amber_plant();
  model::StateVector state = tumbling();
  plant.set_state(state);
  PlantRobot robot(plant, {parse_fault("encoder-freeze:knee_L@0.5")}, 0.001);
  hal::RobotReadings readings;
  robot.read(1, readings);
  const double frozen_rad = readings.joints[kKnee].position_rad;
  robot.set_time(0.5);

  state[model::kFirstJoint + static_cast<int>(kKnee)] += 0.3;
  plant.set_state(state);
  robot.read(2, readings);
  EXPECT_EQ(readings.joints[kKnee].position_rad, frozen_rad);
  hal::JointCommands commands{};
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    commands[joint] = {.position_rad = readings.joints[joint].position_rad + kAhead_rad,
                       .kp_Nm_rad = kKp_Nm_rad,
                       .torque_limit_Nm = 80.0};
  }
  ASSERT_EQ(robot.write(commands), hal::JointBusStatus::ok);
  robot.drive();
  plant.step();
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_NEAR(plant.applied_torque_Nm()[static_cast<int>(joint)], kKp_Nm_rad * kAhead_rad, 1e-9) << joint;
  }
}

}  // namespace
}  // namespace stilt::simulation
