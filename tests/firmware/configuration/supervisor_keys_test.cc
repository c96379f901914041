#include <gtest/gtest.h>

#include <string>

#include "firmware/configuration/configuration.h"

// [supervisor]: what may be given.
namespace stilt::configuration {
namespace {

/// All diagnostics of a section, "" when it is accepted.
std::string mistakes(const std::string& lines) {
  const Result result = parse("[supervisor]\n" + lines, "robot.toml");
  return result ? "" : to_string(result.error());
}

// Settings that would switch a check of a robot off.
TEST(SupervisorKeys, ChecksOfTheSupervisorStayInEffect) {
  for (const char* key : {"settle_s = 1.01", "stand_pose_margin_rad = 0.51", "stance_margin_rad = 1.01"}) {
    EXPECT_NE(mistakes(std::string(key) + "\n"), "") << key;
  }
  EXPECT_EQ(mistakes("settle_s = 1\nstand_pose_margin_rad = 0.5\nstance_margin_rad = 1\n"), "");
}

// With less, each stop would leave the joints limp.
TEST(SupervisorKeys, DampingHasALeastGainAndTorqueAlsoOfAHotJoint) {
  for (const char* key : {"damping_kd_Nms_rad = 0", "damping_kd_Nms_rad = 0.99", "damping_torque_Nm = 0",
                          "damping_torque_Nm = 4.9", "hot_torque_share = 0", "hot_torque_share = 0.29"}) {
    EXPECT_NE(mistakes(std::string(key) + "\n"), "") << key;
  }
  EXPECT_EQ(mistakes("damping_kd_Nms_rad = 1\ndamping_torque_Nm = 5\nhot_torque_share = 0.3\n"), "");
}

TEST(SupervisorKeys, TheGainsOfSittingGrowInItsFirstQuarter) {
  EXPECT_EQ(mistakes("hold_ramp_s = 0.5\n"), "");
  EXPECT_EQ(mistakes("hold_ramp_s = 0.6\n"),
            "robot.toml:2:15: supervisor.hold_ramp_s = 0.6 must be at most a quarter of supervisor.sit_s, "
            "0.5: the robot would fall before the gains of sitting are there");
  EXPECT_TRUE(mistakes("sit_s = 0.1\n").starts_with("robot.toml:2:"));
  EXPECT_EQ(mistakes("sit_s = 4\nhold_ramp_s = 1\n"), "");
  EXPECT_NE(mistakes("sit_s = 60\nhold_ramp_s = 1.1\n"), "");
}

TEST(SupervisorKeys, AStandThatWaitsIsVoidAfterTenMinutesAtMost) {
  EXPECT_EQ(mistakes("stand_wait_s = 600\n"), "");
  EXPECT_NE(mistakes("stand_wait_s = 601\n"), "");
}

TEST(SupervisorKeys, AGaitThatIsSelectedMustBeTracked) {
  EXPECT_EQ(mistakes("select_gait = true\n"), "");
  EXPECT_EQ(mistakes("select_gait = true\ntrack_gait = false\n"),
            "robot.toml:2:15: supervisor.select_gait = true needs supervisor.track_gait = true: no gait is "
            "tracked otherwise");
}

}  // namespace
}  // namespace stilt::configuration
