#include "host_tools/simulation/robot_on_bus/hand_commands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/host_tools/simulation/robot_on_bus/driven_robot.h"

namespace stilt::robot_on_bus {
namespace {

constexpr int kPitch = model::kFirstAngle, kHipLeft = model::kFirstJoint, kKneeLeft = kHipLeft + 1;
constexpr double kSettled_rad = 0.02;

RobotSetup hanging() {
  RobotSetup setup = testing_support::setup_of({});
  setup.gantry = hanging_for_good();
  return setup;
}

/// A robot whose motors are off, and the hands on it.
class HandCommandsTest : public testing::Test {
 protected:
  /// Until something is reported.
  HandReport until_report() {
    HandReport report;
    for (int i = 0; i < 20'000 && report.sentence.empty(); ++i) report = tick();
    return report;
  }
  HandReport tick() {
    HandReport report = hands_.serve(robot_);
    robot_.tick(now_ns_ += testing_support::kTick_ns);
    return report;
  }
  [[nodiscard]] double angle_rad(int index) const { return robot_.plant().state()[index]; }

  RobotOnBus robot_{hanging()};
  HandCommands hands_;
  std::int64_t now_ns_ = 0;
};

TEST_F(HandCommandsTest, LinesAreDoneOneAfterTheOther) {
  hands_.type("knee_L 0\n  hip_L   -1.6 \n\nhip_");
  EXPECT_EQ(until_report().sentence, "1: knee_L 0: done");
  EXPECT_NEAR(angle_rad(kKneeLeft), 0, kSettled_rad);
  EXPECT_GT(std::abs(angle_rad(kHipLeft) + 1.6), 1.0) << "not begun";
  EXPECT_EQ(until_report().sentence, "2: hip_L -1.6: done");
  EXPECT_NEAR(angle_rad(kHipLeft), -1.6, kSettled_rad);
  EXPECT_NEAR(angle_rad(kKneeLeft), 0, kSettled_rad) << "still held";
  hands_.type("L 0");
  EXPECT_TRUE(until_report().sentence.empty()) << "the line has not ended";
  hands_.end_line();
  EXPECT_EQ(until_report().sentence, "3: hip_L 0: done");
  EXPECT_NEAR(angle_rad(kHipLeft), 0, kSettled_rad);
}

TEST_F(HandCommandsTest, LegsThatAreLetGoHangStill) {
  hands_.type("hip_L -1.6\nlet go\n");
  EXPECT_FALSE(until_report().bad_line);
  EXPECT_EQ(until_report().sentence, "2: let go: done");
  EXPECT_NEAR(angle_rad(kHipLeft) + angle_rad(kPitch), 0, kSettled_rad);
  EXPECT_LT(robot_.plant().state().tail<model::kJoints>().cwiseAbs().maxCoeff(), 0.01);
}

TEST_F(HandCommandsTest, RockingTurnsTheTorsoAgainstAStillThighUntilTheNextLine) {
  hands_.type("let go\nrock\n");
  EXPECT_FALSE(until_report().bad_line);
  const double thigh_rad = angle_rad(kPitch) + angle_rad(kHipLeft);
  double forward_rad = 0, backward_rad = 0, thigh_moved_rad = 0;
  HandReport report;
  for (int i = 0; i < 20'000 && report.sentence.empty(); ++i) {
    report = tick();
    forward_rad = std::max(forward_rad, angle_rad(kPitch));
    backward_rad = std::min(backward_rad, angle_rad(kPitch));
    thigh_moved_rad =
        std::max(thigh_moved_rad, std::abs(angle_rad(kPitch) + angle_rad(kHipLeft) - thigh_rad));
  }
  EXPECT_EQ(report.sentence, "2: rock: done");
  EXPECT_GT(forward_rad, 0.17) << "10 degrees";
  EXPECT_LT(backward_rad, -0.17);
  EXPECT_LT(thigh_moved_rad, 0.03);
  hands_.type("torso 0.1\n");
  EXPECT_EQ(until_report().sentence, "3: torso 0.1: done");
  EXPECT_NEAR(angle_rad(kPitch), 0.1, kSettled_rad) << "no rocking any more";
}

TEST_F(HandCommandsTest, ALineThatIsNoneIsNamedAndTheNextIsDone) {
  hands_.type("hip_L x\nknee_L 0\n");
  const HandReport report = until_report();
  EXPECT_TRUE(report.bad_line);
  EXPECT_EQ(report.sentence,
            "line 1, \"hip_L x\", is none of JOINT RAD, torso RAD, rock, let go, with at most 3.2 rad");
  EXPECT_EQ(until_report().sentence, "2: knee_L 0: done");
  hands_.type("hip_L 3.3\n");
  EXPECT_TRUE(until_report().bad_line) << "no joint turns that far";
}

}  // namespace
}  // namespace stilt::robot_on_bus
