#include "firmware/supervisor/safe_commands.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/firmware/supervisor/observations.h"

namespace stilt::supervisor {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const SupervisorParameters kParameters;

double torque_Nm(const hal::JointCommand& command, double position_rad, double velocity_rad_s) {
  return command.torque_Nm + command.kp_Nm_rad * (command.position_rad - position_rad) +
         command.kd_Nms_rad * (command.velocity_rad_s - velocity_rad_s);
}

hal::JointCommands some_commands() {
  hal::JointCommands commands;
  commands.fill({.position_rad = 0.3,
                 .velocity_rad_s = 1.5,
                 .torque_Nm = 20,
                 .kp_Nm_rad = 60,
                 .kd_Nms_rad = 3,
                 .torque_limit_Nm = 80});
  return commands;
}

TEST(Damped, ResistsMotionAndNothingElseWithinItsBound) {
  hal::JointReadings measured = testing::healthy().joints;
  for (const double velocity_rad_s : {-100.0, -7.9, -1.0, 0.0, 0.5, 8.1, 1e6}) {
    for (hal::JointReading& joint : measured) joint.velocity_rad_s = velocity_rad_s;
    for (const hal::JointCommand& command : damped(measured, testing::joint_limits(), kParameters)) {
      EXPECT_EQ(command.kp_Nm_rad, 0);
      EXPECT_EQ(command.torque_Nm, 0);
      EXPECT_EQ(command.velocity_rad_s, 0);
      const double torque = torque_Nm(command, -5, velocity_rad_s);
      EXPECT_LE(torque * velocity_rad_s, 0) << "never drives";
      EXPECT_LE(std::abs(torque), kParameters.damping_torque_Nm * (1 + 1e-12));
    }
  }
}

TEST(Damped, StaysWithinTheTorqueOfAWeakJoint) {
  JointLimits weak = testing::joint_limits();
  weak.torque_Nm[2] = 0.25 * kParameters.damping_torque_Nm;
  hal::JointReadings measured = testing::healthy().joints;
  for (hal::JointReading& joint : measured) joint.velocity_rad_s = 1e3;
  const hal::JointCommands commands = damped(measured, weak, kParameters);
  EXPECT_NEAR(torque_Nm(commands[2], 0, 1e3), -weak.torque_Nm[2], 1e-9);
  EXPECT_EQ(commands[2].torque_limit_Nm, weak.torque_Nm[2]);
  EXPECT_NEAR(torque_Nm(commands[1], 0, 1e3), -kParameters.damping_torque_Nm, 1e-9);
}

TEST(Damped, IsFiniteWhateverTheSensorsReport) {
  hal::JointReadings measured = testing::healthy().joints;
  for (const double value : {kNan, std::numeric_limits<double>::infinity()}) {
    measured[0].position_rad = measured[1].velocity_rad_s = value;
    EXPECT_TRUE(finite(damped(measured, testing::joint_limits(), kParameters)));
  }
}

TEST(Held, PullsToThePoseWithAShareOfTheGains) {
  const hal::JointValues pose_rad{0.1, 0.2, 0.3, 0.4};
  const hal::JointCommands half = held(pose_rad, 0.5, testing::joint_limits(), kParameters);
  const hal::JointCommands full = held(pose_rad, 1.0, testing::joint_limits(), kParameters);
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    EXPECT_DOUBLE_EQ(torque_Nm(full[i], pose_rad[i], 0), 0);
    EXPECT_DOUBLE_EQ(torque_Nm(full[i], pose_rad[i] - 0.1, 0), 0.1 * kParameters.hold_kp_Nm_rad);
    EXPECT_DOUBLE_EQ(torque_Nm(half[i], pose_rad[i] - 0.1, 1),
                     0.5 * torque_Nm(full[i], pose_rad[i] - 0.1, 1));
  }
}

TEST(PoseBetween, BeginsAndEndsAtItsPosesAtRest) {
  const hal::JointValues from{0, 1, -1, 2};
  const hal::JointValues to{1, 0, 3, 2};
  EXPECT_EQ(pose_between_rad(from, to, 0), from);
  EXPECT_EQ(pose_between_rad(from, to, -1), from);
  EXPECT_EQ(pose_between_rad(from, to, 1), to);
  EXPECT_EQ(pose_between_rad(from, to, 7), to);
  const double step = 1e-4;
  EXPECT_LT(std::abs(pose_between_rad(from, to, step)[2] - from[2]), 4 * 4 * step * step);
  EXPECT_LT(std::abs(pose_between_rad(from, to, 1 - step)[2] - to[2]), 4 * 4 * step * step);
}

TEST(BlendIn, GrowsFromDampingToTheWantedCommands) {
  const hal::JointCommands wanted = some_commands();
  const hal::JointValues start_rad{-0.2, 0.4, -0.2, 0.4};
  const hal::JointCommands none = blend_in(wanted, start_rad, 0, kParameters);
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    EXPECT_DOUBLE_EQ(torque_Nm(none[i], 9, 2), -2 * kParameters.damping_kd_Nms_rad);
    for (const double s : {0.25, 0.7}) {
      const hal::JointCommand command = blend_in(wanted, start_rad, s, kParameters)[i];
      const double at_rad = start_rad[i] + s * (wanted[i].position_rad - start_rad[i]);
      const double expected_Nm = s * (wanted[i].torque_Nm + wanted[i].kd_Nms_rad * (1.5 - 0.4)) -
                                 (1 - s) * kParameters.damping_kd_Nms_rad * 0.4;
      EXPECT_NEAR(torque_Nm(command, at_rad, 0.4), expected_Nm, 1e-12);
    }
    const hal::JointCommand all = blend_in(wanted, start_rad, 1, kParameters)[i];
    EXPECT_EQ(torque_Nm(all, 0.1, 0.2), torque_Nm(wanted[i], 0.1, 0.2));
  }
}

TEST(BlendIn, IsFiniteWithoutAnyDamping) {
  SupervisorParameters undamped = kParameters;
  undamped.damping_kd_Nms_rad = 0;
  hal::JointCommands wanted = some_commands();
  for (hal::JointCommand& command : wanted) command.kd_Nms_rad = 0;
  for (const double s : {0.0, 0.5}) EXPECT_TRUE(finite(blend_in(wanted, {}, s, undamped)));
}

TEST(Finite, FindsEveryFieldOfEveryJoint) {
  EXPECT_TRUE(finite(some_commands()));
  for (double hal::JointCommand::* field :
       {&hal::JointCommand::position_rad, &hal::JointCommand::velocity_rad_s, &hal::JointCommand::torque_Nm,
        &hal::JointCommand::kp_Nm_rad, &hal::JointCommand::kd_Nms_rad, &hal::JointCommand::torque_limit_Nm}) {
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      hal::JointCommands commands = some_commands();
      commands[joint].*field = kNan;
      EXPECT_FALSE(finite(commands));
    }
  }
}

TEST(Bounded, KeepsTorquesWithinTheJointsAndGainsPositive) {
  hal::JointCommands commands = some_commands();
  commands[0].torque_Nm = 200;
  commands[1].torque_Nm = -200;
  commands[2].torque_limit_Nm = 1e9;
  commands[3].kp_Nm_rad = commands[3].kd_Nms_rad = -1;
  const hal::JointCommands result = bounded(commands, {}, testing::joint_limits());
  EXPECT_EQ(result[0].torque_Nm, 80);
  EXPECT_EQ(result[1].torque_Nm, -80);
  EXPECT_EQ(result[2].torque_limit_Nm, 80);
  EXPECT_EQ(result[3].kp_Nm_rad, 0);
  EXPECT_EQ(result[3].kd_Nms_rad, 0);
  EXPECT_EQ(result[0].kp_Nm_rad, 60) << "the rest stays";
}

/// The driver follows its law without a limit of its own.
TEST(Bounded, LowersTheGainsOfALawThatAsksForMoreThanTheLimit) {
  hal::JointReadings measured = testing::healthy().joints;
  for (int i = 0; i < 4; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    measured[joint].position_rad = 0.3 * i - 0.5;
    measured[joint].velocity_rad_s = 4.0 - 3.0 * i;
    hal::JointCommands commands{};
    hal::JointCommand& command = commands[joint];
    command = {
        .position_rad = 1.2, .torque_Nm = -20, .kp_Nm_rad = 300, .kd_Nms_rad = 6, .torque_limit_Nm = 80};
    const double asked_Nm = torque_Nm(command, measured[joint].position_rad, measured[joint].velocity_rad_s);
    const hal::JointCommand result = bounded(commands, measured, testing::joint_limits())[joint];
    const double given_Nm = torque_Nm(result, measured[joint].position_rad, measured[joint].velocity_rad_s);
    EXPECT_GT(std::abs(asked_Nm), 80) << joint;
    EXPECT_NEAR(given_Nm, asked_Nm > 0 ? 80 : -80, 1e-9) << joint;
    EXPECT_EQ(result.torque_Nm, -20) << joint;
  }
}

TEST(Bounded, LeavesALawWithinTheLimitAsItIs) {
  const hal::JointReadings measured = testing::healthy().joints;
  hal::JointCommands commands{};
  commands.fill(
      {.position_rad = 0.5, .torque_Nm = 30, .kp_Nm_rad = 60, .kd_Nms_rad = 2, .torque_limit_Nm = 80});
  const hal::JointCommands result = bounded(commands, measured, testing::joint_limits());
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    EXPECT_EQ(result[i].kp_Nm_rad, 60);
    EXPECT_EQ(result[i].kd_Nms_rad, 2);
  }
}

TEST(Derated, TheTorqueLimitFallsWithTheHotterTemperature) {
  hal::JointReadings measured = testing::healthy().joints;
  measured[0].driver_temperature_C = kParameters.hot_C;
  measured[1].motor_temperature_C = 0.5 * (kParameters.hot_C + kParameters.overheated_C);
  measured[2].driver_temperature_C = 200;
  measured[3].driver_temperature_C = measured[3].motor_temperature_C = kNan;
  const JointLimits result = derated(testing::joint_limits(), measured, kParameters);
  EXPECT_EQ(result.torque_Nm[0], 80);
  EXPECT_NEAR(result.torque_Nm[1], 80 * (0.5 + 0.5 * kParameters.hot_torque_share), 1e-12);
  EXPECT_NEAR(result.torque_Nm[2], 80 * kParameters.hot_torque_share, 1e-12);
  EXPECT_EQ(result.torque_Nm[3], 80);
  EXPECT_EQ(result.speed_rad_s, testing::joint_limits().speed_rad_s);
}

TEST(MeasuredPose, KeepsTheLastFinitePosition) {
  hal::JointReadings measured = testing::healthy().joints;
  measured[1].position_rad = kNan;
  const hal::JointValues pose_rad = measured_pose_rad(measured, {7, 8, 9, 10});
  EXPECT_EQ(pose_rad[0], -0.2);
  EXPECT_EQ(pose_rad[1], 8);
}

}  // namespace
}  // namespace stilt::supervisor
