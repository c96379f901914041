// The stand with a robot in it, under the predictive controller or without any.
#include <gtest/gtest.h>

#include "tests/host_tools/simulation/robot_on_bus/mpc_driver.h"

namespace stilt::robot_on_bus {
namespace {

using testing_support::DrivenRobot;
using testing_support::MpcDriver;

constexpr gait::GaitCommand kStand{gait::GaitKind::stand, 0.0};
constexpr gait::GaitCommand kWalk{gait::GaitKind::walk, 0.5};

TEST(GantryLoop, WithoutAControllerTheRobotHangsStill) {
  DrivenRobot driven;
  for (int i = 0; i < 5000; ++i) driven.tick();
  EXPECT_EQ(driven.robot.gantry().state(), GantryState::holding);
  const model::StateVector hanging = driven.robot.gantry().hanging();
  EXPECT_LT((driven.robot.plant().state() - hanging).cwiseAbs().maxCoeff(), 0.05);
  EXPECT_GT(driven.robot.plant().foot_position_m()[1], 0.0);
  EXPECT_GT(driven.robot.plant().foot_position_m()[3], 0.0);
}

TEST(GantryLoop, DriversWithoutTorqueDoNotEndIt) {
  DrivenRobot driven;
  ASSERT_TRUE(driven.enable());
  const hal::JointCommands nothing{};
  for (int i = 0; i < 5000; ++i) driven.tick(&nothing);
  EXPECT_EQ(driven.robot.gantry().state(), GantryState::holding);
}

TEST(GantryLoop, ARobotThatStandsIsReleasedAndWalksAway) {
  DrivenRobot driven;
  ASSERT_TRUE(driven.enable());
  MpcDriver controller(driven);
  for (int i = 0; i < 2500; ++i) controller.tick(kStand);
  ASSERT_TRUE(driven.robot.gantry_released_s());
  EXPECT_LT(*driven.robot.gantry_released_s(), 2.0);
  for (int i = 0; i < 10'000; ++i) controller.tick(kWalk);
  driven.robot.finish();
  const log::RunSummary& summary = driven.robot.recorder().record().summary;
  EXPECT_TRUE(summary.survived) << simulation::fall_text(driven.robot.recorder().fall());
  EXPECT_NEAR(summary.mean_speed_m_s, 0.5, 0.03);
  EXPECT_GT(summary.steps.size(), 25u);
}

TEST(GantryLoop, ARobotWhoseControllerFallsSilentFallsAndIsLiftedAgain) {
  DrivenRobot driven;
  ASSERT_TRUE(driven.enable());
  MpcDriver controller(driven);
  for (int i = 0; i < 2500; ++i) controller.tick(kStand);
  for (int i = 0; i < 1000; ++i) controller.tick(kWalk);
  for (int i = 0; i < 25; ++i) driven.tick();
  EXPECT_FALSE(driven.robot.drivers().all_enabled()) << "watchdogs of 20 ms";
  for (int i = 0; i < 8000; ++i) driven.tick();
  const log::RunSummary& summary = driven.robot.recorder().record().summary;
  EXPECT_FALSE(summary.survived);
  EXPECT_GT(summary.fall_time_s, 1.0);
  EXPECT_EQ(driven.robot.gantry().state(), GantryState::holding);
  EXPECT_NEAR(driven.robot.plant().state()[1], driven.robot.gantry().hanging()[1], 0.02);
}

/// Damping, as a supervisor asks for after a fault.
hal::JointCommands damping(const hal::JointReadings& readings) {
  hal::JointCommands commands{};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    commands[i].position_rad = readings[i].position_rad;
    commands[i].kd_Nms_rad = 4.5;
    commands[i].torque_limit_Nm = 40.0;
  }
  return commands;
}

// A leg that is straighter than in the pose would jam between hip and ground.
TEST(GantryLoop, ARobotThatFallsDampedHangsInItsPoseAgainWhateverItsStep) {
  for (const int walked : {1000, 1120, 1240, 1360}) {
    DrivenRobot driven;
    ASSERT_TRUE(driven.enable());
    MpcDriver controller(driven);
    for (int i = 0; i < 2500; ++i) controller.tick(kStand);
    for (int i = 0; i < walked; ++i) controller.tick(kWalk);
    for (int i = 0; i < 10'000; ++i) {
      const hal::JointCommands commands = damping(driven.readings);
      driven.tick(&commands);
    }
    EXPECT_EQ(driven.robot.gantry().state(), GantryState::holding) << walked;
    model::StateVector hanging = driven.robot.gantry().hanging();
    hanging[0] = driven.robot.plant().state()[0];
    EXPECT_LT((driven.robot.plant().state() - hanging).cwiseAbs().maxCoeff(), 0.05) << walked;
  }
}

}  // namespace
}  // namespace stilt::robot_on_bus
