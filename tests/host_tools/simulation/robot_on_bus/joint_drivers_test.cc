#include "host_tools/simulation/robot_on_bus/joint_drivers.h"

#include <gtest/gtest.h>

#include "tests/host_tools/simulation/robot_on_bus/driven_robot.h"

namespace stilt::robot_on_bus {
namespace {

using testing_support::DrivenRobot;
using testing_support::RobotRequest;

/// The shipped wiring with other drivers.
RobotRequest drivers(const std::string& protocol, const std::string& ratio) {
  RobotRequest request;
  const std::vector<std::string> settings = {
      "protocol=" + protocol,
      "ratio=" + ratio,
      std::string("position_range_rad=") + (protocol == "ak_v3" ? "12.56" : "40"),
      "accept_missing_watchdog=true",
      "moteus_kp_Nm_rev=4000",
      "moteus_kd_Nms_rev=400",
      "odrive_watchdog_timeout_endpoint=17",
      "odrive_enable_watchdog_endpoint=18",
      "odrive_firmware_version=0.6.11",
      "odrive_hardware_version=4.4.58"};
  for (const std::string which : {"hip_driver.", "knee_driver."}) {
    for (const std::string& setting : settings) request.settings.push_back(which + setting);
  }
  request.settings.emplace_back("knee_L.offset_rad=0.4");
  return request;
}

class JointDriversOf : public testing::TestWithParam<const char*> {};

TEST_P(JointDriversOf, WhatIsCommandedAtTheJointArrivesAtTheJoint) {
  DrivenRobot driven(drivers(GetParam(), "6"));
  ASSERT_TRUE(driven.enable());
  hal::JointCommands commands;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    commands[joint] = {.torque_Nm = joint % 2 == 0 ? 5.0 : -7.0, .torque_limit_Nm = 80};
  }
  driven.tick(&commands);
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_NEAR(driven.robot.drivers().torque_Nm(joint), commands[joint].torque_Nm, 0.4) << joint;
  }
}

/// The motor gives less than its driver is asked for, and the controller asks for more.
TEST_P(JointDriversOf, ATorqueFactorIsOfTheMotorAndTheControllerMakesUpForIt) {
  RobotRequest request = drivers(GetParam(), "6");
  request.settings.emplace_back("hip_R.torque_factor=0.8");
  DrivenRobot driven(request);
  ASSERT_TRUE(driven.enable());
  hal::JointCommands commands;
  for (hal::JointCommand& command : commands) command = {.torque_Nm = 10.0, .torque_limit_Nm = 80};
  driven.tick(&commands);
  constexpr std::size_t kHipRight = 2;
  EXPECT_NEAR(driven.robot.drivers().torque_Nm(kHipRight), 10.0, 0.4);
  const double turns = driven.setup.wiring.joints[kHipRight].direction * 6;
  EXPECT_NEAR(turns * driven.robot.drivers().driver(kHipRight).torque_Nm(), 12.5, 0.5);
}

TEST(JointDrivers, AllAreEnabledUntilOneStartsAgain) {
  DrivenRobot driven(drivers("mit_damiao", "6"));
  ASSERT_TRUE(driven.enable());
  EXPECT_TRUE(driven.robot.drivers().all_enabled());
  driven.robot.drivers().driver(2).power_cycle();
  EXPECT_FALSE(driven.robot.drivers().all_enabled());
}

TEST_P(JointDriversOf, TheMotionOfTheJointComesBack) {
  DrivenRobot driven(drivers(GetParam(), "6"));
  ASSERT_TRUE(driven.enable());
  const hal::JointCommands nothing{};
  for (int i = 0; i < 3; ++i) driven.tick(&nothing);
  const model::StateVector state = driven.robot.plant().state();
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const auto q = static_cast<int>(model::kFirstJoint + joint);
    EXPECT_NEAR(driven.readings[joint].position_rad, state[q], 1e-3) << joint;
    EXPECT_NEAR(driven.readings[joint].velocity_rad_s, state[model::kPositions + q], 0.02) << joint;
  }
}

INSTANTIATE_TEST_SUITE_P(EveryProtocol, JointDriversOf,
                         testing::Values("mit_damiao", "moteus", "odrive", "ak_v3"),
                         [](const auto& row) { return std::string(row.param); });

/// The pitch as an extra encoder of a joint's driver, whichever way it is mounted.
TEST(JointDrivers, AnExtraEncoderShowsThePitchOfTheBase) {
  for (const char* reversed : {"false", "true"}) {
    RobotRequest request = drivers("moteus", "6");
    request.settings.emplace_back("torso_sensor.encoder_joint=2");
    request.settings.emplace_back(std::string("torso_sensor.encoder_reversed=") + reversed);
    request.settings.emplace_back("torso_sensor.encoder_offset_rad=0.15");
    DrivenRobot driven(request);
    ASSERT_TRUE(driven.enable());
    const hal::JointCommands nothing{};
    for (int i = 0; i < 3; ++i) driven.tick(&nothing);
    const model::StateVector state = driven.robot.plant().state();
    EXPECT_EQ(driven.base.missed_replies, 0u);
    EXPECT_NEAR(driven.base.pitch_rad, state[model::kFirstAngle], 1e-3) << reversed;
    EXPECT_NEAR(driven.base.pitch_rate_rad_s, state[model::kPositions + model::kFirstAngle], 0.02)
        << reversed;
  }
}

TEST(JointDrivers, ADriverThatIsNotEnabledGivesNoTorque) {
  DrivenRobot driven;
  hal::JointCommands commands;
  for (hal::JointCommand& command : commands) command = {.torque_Nm = 20, .torque_limit_Nm = 80};
  driven.tick(&commands);
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_EQ(driven.robot.drivers().torque_Nm(joint), 0.0);
  }
}

TEST(JointDrivers, TheDriversLawSeesTheMotionOfEachTimeStep) {
  DrivenRobot driven;
  ASSERT_TRUE(driven.enable());
  hal::JointCommands commands;
  for (hal::JointCommand& command : commands) command = {.kd_Nms_rad = 4, .torque_limit_Nm = 80};
  commands[0].torque_Nm = 40;  // the left hip swings
  driven.tick(&commands);
  driven.robot.step(driven.now_ns);
  const double first_Nm = driven.robot.drivers().torque_Nm(0);
  driven.robot.step(driven.now_ns);
  const double second_Nm = driven.robot.drivers().torque_Nm(0);
  const double velocity_rad_s = driven.robot.plant().state()[model::kPositions + model::kFirstJoint];
  EXPECT_NE(first_Nm, second_Nm) << "no command came in between";
  EXPECT_NEAR(second_Nm, 40 - 4 * velocity_rad_s, 0.1);
}

}  // namespace
}  // namespace stilt::robot_on_bus
