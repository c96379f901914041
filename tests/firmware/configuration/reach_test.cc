#include "firmware/configuration/reach.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/robots/robots.h"

namespace stilt::configuration {
namespace {

std::vector<std::string> of(const Configuration& configuration) {
  const auto robot = robots::find(configuration.hardware.robot);
  EXPECT_TRUE(robot) << configuration.hardware.robot;
  return unreachable(configuration, (*robot)->model.constants);
}

bool says(const std::vector<std::string>& sentences, const std::string& start) {
  return std::ranges::any_of(sentences, [&](const std::string& line) { return line.starts_with(start); });
}

TEST(Reach, TheShippedRobotsFitTheFramesOfTheirDrivers) {
  for (const char* robot : {"amber3m", "rabbit"}) EXPECT_TRUE(of(load_robot(robot).value()).empty()) << robot;
}

// A knee of 2.4 rad behind a ratio of 9 turns the shaft by 3.44 revolutions; a command ends at 3.2767.
TEST(Reach, AKneeBehindARatioOf9IsTooFarForTheCommandsOfAMoteus) {
  Configuration configuration = load_robot("amber3m").value();
  configuration.hardware.knee.protocol = DriverProtocol::moteus;
  configuration.hardware.knee.ratio = 6;
  EXPECT_FALSE(says(of(configuration), "knee_L: commands an angle"));
  configuration.hardware.knee.ratio = 9;
  const std::vector<std::string> found = of(configuration);
  EXPECT_TRUE(says(found, "knee_L: commands an angle of up to "));
  EXPECT_TRUE(says(found, "knee_R: commands an angle of up to "));
  EXPECT_TRUE(says(found, "knee_L: commands a velocity of up to 90 rad/s at the shaft"));
  EXPECT_FALSE(says(found, "knee_L: reads")) << "replies are wide enough";
  EXPECT_FALSE(says(found, "hip_L"));
}

TEST(Reach, ARangeOfMitModeBelowTheTravelIsNamedForCommandsAndReplies) {
  Configuration configuration = load_robot("amber3m").value();
  configuration.hardware.knee.position_range_rad = 0.5;
  EXPECT_TRUE(says(of(configuration), "knee_L: commands an angle"));
  EXPECT_TRUE(says(of(configuration), "knee_L: reads an angle"));
  configuration.hardware.knee.position_range_rad = 12.5;
  configuration.hardware.knee.velocity_range_rad_s = 9;
  EXPECT_TRUE(says(of(configuration), "knee_R: commands a velocity"));
  configuration.hardware.knee.velocity_range_rad_s = 12;
  EXPECT_FALSE(says(of(configuration), "knee_R: commands a velocity"));
  EXPECT_TRUE(says(of(configuration), "knee_R: reads a velocity")) << "its limit and margin could never show";
}

TEST(Reach, LimitsOfTheSupervisorLeaveRoomForTheStand) {
  Configuration configuration = load_robot("amber3m").value();  // stands at 0.92 of its leg
  const std::string hip = "supervisor.hip_height_share = 0.95 must be at least 0.05 below";
  configuration.supervisor.hip_height_share = 0.95;
  EXPECT_TRUE(says(of(configuration), hip)) << "damped as soon as it stands";
  configuration.supervisor.hip_height_share = 0.85;
  EXPECT_TRUE(of(configuration).empty());
  configuration.supervisor.base_pitch_limit_rad = 0.5;
  configuration.reference.base_pitch_rad = -0.45;
  EXPECT_TRUE(
      says(of(configuration), "supervisor.base_pitch_limit_rad = 0.5 must be at least 0.1 rad above"));
  configuration.reference.base_pitch_rad = -0.3;
  EXPECT_FALSE(says(of(configuration), "supervisor."));
}

TEST(Reach, AStandingPoseHasEitherFootAhead) {
  const Configuration configuration = load_robot("amber3m").value();
  for (const int joint : {0, 2}) {
    model::RobotConstants robot = (*robots::find("amber3m"))->model.constants;
    robot.position_min_rad[joint] = -0.3;
    const std::vector<std::string> found = unreachable(configuration, robot);
    EXPECT_TRUE(says(found, std::string(joint == 0 ? "hip_L" : "hip_R") + ": reference.base_height_m"))
        << joint;
  }
}

TEST(Reach, ASittingPoseBeyondTheTravelOfAJointIsNamed) {
  Configuration configuration = load_robot("amber3m").value();
  configuration.supervisor.sit_hip_rad = -1.7;
  EXPECT_EQ(of(configuration).at(0),
            "hip_L: supervisor.sit_hip_rad = -1.7 is beyond the joint's travel, -1.6 to 1.6 rad; give a pose "
            "in which "
            "this robot sits");
  EXPECT_EQ(of(configuration).size(), 2u);
  configuration.supervisor.sit_hip_rad = -1.6;
  configuration.supervisor.sit_knee_rad = 2.5;
  EXPECT_TRUE(says(of(configuration), "knee_R: supervisor.sit_knee_rad = 2.5"));
}

// Legs of 0.8731 m, a quarter of which is 0.2183 m.
TEST(Reach, FeetOfTheSittingPoseAreBelowTheHipAndNearIt) {
  Configuration configuration = load_robot("amber3m").value();
  const auto sits_at = [&](double hip_rad, double knee_rad) {
    configuration.supervisor.sit_hip_rad = hip_rad;
    configuration.supervisor.sit_knee_rad = knee_rad;
    return of(configuration);
  };
  EXPECT_EQ(sits_at(1.5, 0),
            std::vector<std::string>{
                "supervisor.sit_hip_rad = 1.5 and supervisor.sit_knee_rad = 0 put the feet 0.8709 m behind "
                "the hip and 0.0618 m below it; this robot sits on feet at most 0.2183 m ahead or behind, "
                "below the hip by less than reference.base_height_m = 0.8"});
  EXPECT_TRUE(says(sits_at(-1.5, 0),
                   "supervisor.sit_hip_rad = -1.5 and supervisor.sit_knee_rad = 0 put the "
                   "feet 0.8709 m ahead of the hip"));
  EXPECT_TRUE(says(sits_at(1.6, 2.4),
                   "supervisor.sit_hip_rad = 1.6 and supervisor.sit_knee_rad = 2.4 put "
                   "the feet 0.053 m behind the hip and 0.3169 m above it"));
  EXPECT_EQ(sits_at(0, 0).size(), 1u) << "it would straighten its legs, and fall from there";
  EXPECT_EQ(sits_at(-0.65, 2.2).size(), 1u) << "0.2207 m behind";
  EXPECT_EQ(sits_at(-0.7, 2.2), std::vector<std::string>()) << "0.2037 m";
  EXPECT_EQ(sits_at(-1.2, 2.4), std::vector<std::string>());
}

// It stands with knees of 0.742 rad and hips of -0.583 and -0.213 rad: up to 1.458 and 0.887 rad from its
// sitting pose. Its joints turn at 10 rad/s at most.
TEST(Reach, SittingDownTakesNoJointBeyondHalfOfItsSpeedLimit) {
  Configuration configuration = load_robot("amber3m").value();
  const auto sits_in = [&](double sit_s) {
    configuration.supervisor.sit_s = sit_s;
    return of(configuration);
  };
  EXPECT_EQ(sits_in(0.438), std::vector<std::string>());
  const std::vector<std::string> found = sits_in(0.3);
  EXPECT_EQ(found.size(), 2u) << "both knees";
  EXPECT_EQ(
      found.at(0),
      "knee_L: supervisor.sit_s = 0.3 takes it from the stand to the sitting pose at up to 7.2884 rad/s, "
      "beyond 5 rad/s, half of its speed limit; sit down in at least 0.438 s");
  EXPECT_EQ(sits_in(0.437).size(), 2u);
  EXPECT_EQ(sits_in(0.267).size(), 2u);
  EXPECT_EQ(sits_in(0.266).size(), 4u) << "either leg may be the one behind, whose hip goes farther";
  configuration.supervisor.sit_s = 2;
  model::RobotConstants slow = (*robots::find("amber3m"))->model.constants;
  slow.velocity_limit_rad_s[1] = 2;
  EXPECT_TRUE(says(unreachable(configuration, slow), "knee_L: supervisor.sit_s = 2 takes it"));
}

TEST(Reach, EveryShippedRobotStandsWithEveryPreset) {
  for (const ShippedConfiguration& shipped : shipped_configurations()) {
    EXPECT_EQ(of(load_robot(shipped.robot).value()), std::vector<std::string>()) << shipped.robot;
    for (const ShippedPreset& preset : shipped_presets()) {
      EXPECT_EQ(of(load_robot(shipped.robot, {}, preset.name).value()), std::vector<std::string>())
          << shipped.robot << ", " << preset.name;
    }
  }
}

// Legs of 0.4064 m and 0.4667 m.
TEST(Reach, AStandingPoseBeyondTheReachOfTheLegsIsNamed) {
  Configuration configuration = load_robot("amber3m").value();
  const auto stands_at = [&](double height_m, double half_width_m) {
    configuration.reference.base_height_m = height_m;
    configuration.gait.stand_half_width_m = half_width_m;
    return of(configuration).empty();
  };
  configuration.reference.base_height_m = 0.9;
  EXPECT_EQ(of(configuration),
            std::vector<std::string>{
                "reference.base_height_m = 0.9 and gait.stand_half_width_m = 0.15 put the feet 0.9124 m from "
                "the hip, and legs of 0.4064 m and 0.4667 m reach from 0.0603 to 0.8731 m; give a pose in "
                "which this robot stands"});
  EXPECT_FALSE(stands_at(1.2, 0.15));
  EXPECT_TRUE(stands_at(0.86, 0.15));
  EXPECT_FALSE(stands_at(0.8602, 0.15));
  EXPECT_TRUE(stands_at(0.8602, 0.14));
}

TEST(Reach, AStandingPoseBeyondTheTravelOfAJointIsNamed) {
  Configuration configuration = load_robot("amber3m").value();
  configuration.reference.base_height_m = 0.1;
  EXPECT_TRUE(
      says(of(configuration), "knee_L: reference.base_height_m = 0.1 and gait.stand_half_width_m = "));
  EXPECT_TRUE(says(of(configuration), "knee_R: reference.base_height_m = 0.1"));
  configuration.reference.base_height_m = 0.8;
  configuration.reference.base_pitch_rad = 1.0;
  configuration.supervisor.base_pitch_limit_rad = 2.0;
  EXPECT_EQ(of(configuration), std::vector<std::string>());
  configuration.reference.base_pitch_rad = 1.5;
  EXPECT_TRUE(says(of(configuration), "hip_L: reference.base_height_m = 0.8"));
}

TEST(Reach, AnAkOfVersionThreeReadsFartherThanItIsCommanded) {
  Configuration configuration = load_robot("amber3m").value();
  configuration.hardware.knee.protocol = DriverProtocol::ak_v3;
  configuration.hardware.knee.position_range_rad = 12.56;
  EXPECT_TRUE(of(configuration).empty());
  configuration.hardware.knee.ratio = 6;
  EXPECT_TRUE(says(of(configuration), "knee_L: commands an angle of up to "));
  EXPECT_FALSE(says(of(configuration), "knee_L: reads an angle")) << "3276.7 degrees";
}

TEST(Reach, AnOffsetMovesTheTravelAtTheShaft) {
  Configuration configuration = load_robot("amber3m").value();
  configuration.hardware.joint[1].offset_rad = -1;
  EXPECT_TRUE(says(of(configuration), "knee_L: commands an angle of up to 3.5 rad"));
}

// 80 Nm at the knee, of which the share may be commanded.
TEST(Reach, ATorqueAtTheShaftDependsOnRatioFactorAndShare) {
  Configuration configuration = load_robot("amber3m").value();
  configuration.hardware.knee.torque_range_Nm = 79;
  EXPECT_TRUE(says(of(configuration), "knee_L: commands a torque of up to 80 Nm at the shaft"));
  configuration.supervisor.torque_limit_share = 0.9;
  EXPECT_FALSE(says(of(configuration), "knee_L"));
  configuration.hardware.joint[1].torque_factor = 0.9;
  EXPECT_TRUE(says(of(configuration), "knee_L: commands a torque of up to 80 Nm at the shaft"));
  EXPECT_FALSE(says(of(configuration), "knee_R"));
  configuration.hardware.knee.ratio = 2;
  EXPECT_FALSE(says(of(configuration), "knee_L: commands a torque"));
}

TEST(Reach, FloatsOfAnOdriveCarryEverything) {
  Configuration configuration = load_robot("amber3m").value();
  configuration.hardware.hip.protocol = configuration.hardware.knee.protocol = DriverProtocol::odrive;
  configuration.hardware.hip.ratio = configuration.hardware.knee.ratio = 100;
  EXPECT_TRUE(of(configuration).empty());
}

}  // namespace
}  // namespace stilt::configuration
