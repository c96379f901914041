#include "firmware/commissioning/wiring_verdict.h"

#include <gtest/gtest.h>

namespace stilt::commissioning {
namespace {

constexpr std::size_t kHipLeft = 0, kKneeLeft = 1;
constexpr double kDegree = 3.14159265358979 / 180;

JogMotion completed(double reached_rad, double leg_reached_rad) {
  JogMotion motion;
  motion.response = Response::with_torque;
  motion.direction = reached_rad > 0 ? 1 : -1;
  motion.reached_rad = reached_rad;
  motion.leg_reached_rad = leg_reached_rad;
  motion.completed = true;
  return motion;
}

Sighting seen(std::size_t link, Way way, double angle_deg) { return {link, way, angle_deg * kDegree}; }

/// The limp thigh of a RABBIT gives way by more than a quarter of its knee's motion: 0.3 rad of the knee turn
/// the shin by 12.5 degrees.
TEST(WiringVerdict, AShinThatTurnsLessThanItsKneeHasTheRightGear) {
  for (const double angle_deg : {9.5, 12.0, 17.0}) {
    const Sighting back = seen(kKneeLeft, Way::backward, angle_deg);
    EXPECT_EQ(judge(kKneeLeft, completed(0.3, -0.082), back, 1).finding, Finding::correct) << angle_deg;
    const Sighting forth = seen(kKneeLeft, Way::forward, angle_deg);
    EXPECT_EQ(judge(kKneeLeft, completed(-0.3, 0.082), forth, 1).finding, Finding::correct) << angle_deg;
  }
}

/// The same motions, read with half and with twice the ratio of the knee.
TEST(WiringVerdict, TheRatioOfAKneeIsFoundBesideAThighThatGivesWay) {
  const Verdict half = judge(kKneeLeft, completed(0.15, -0.082), seen(kKneeLeft, Way::backward, 12.5), 1);
  EXPECT_EQ(half.finding, Finding::wrong_ratio);
  EXPECT_NE(half.sentence.find("encoders of hip_L and knee_L say 4; the ratio is about 0.5, and"),
            std::string::npos)
      << half.sentence;
  const Verdict twice = judge(kKneeLeft, completed(-0.6, 0.082), seen(kKneeLeft, Way::forward, 12.5), 1);
  EXPECT_EQ(twice.finding, Finding::wrong_ratio);
  EXPECT_NE(twice.sentence.find("the ratio is about 2, and the configuration has 1"), std::string::npos)
      << twice.sentence;
}

TEST(WiringVerdict, AThighTurnsWithItsHip) {
  const Sighting back = seen(kHipLeft, Way::backward, 17);
  EXPECT_EQ(judge(kHipLeft, completed(0.3, -0.3), back, 1).finding, Finding::correct);
  const Verdict half = judge(kHipLeft, completed(0.15, -0.3), back, 1);
  EXPECT_EQ(half.finding, Finding::wrong_ratio);
  EXPECT_NE(half.sentence.find("where the encoder of hip_L says 9; the ratio is about 0.506"),
            std::string::npos)
      << half.sentence;
}

JogMotion leg_moved(std::size_t other, double leg_rad) {
  JogMotion motion;
  motion.response = Response::other;
  motion.other = other;
  motion.leg_rad = leg_rad;
  return motion;
}

/// A limp joint of the leg turns against the torque.
TEST(WiringVerdict, AnOtherEncoderThatMovesWithTheTorqueIsExchanged) {
  const Sighting thigh = seen(kHipLeft, Way::backward, 17);
  EXPECT_EQ(judge(kHipLeft, leg_moved(kKneeLeft, 0.06), thigh, 1).finding, Finding::exchanged_encoders);
  EXPECT_EQ(judge(kHipLeft, leg_moved(kKneeLeft, -0.06), thigh, 1).finding, Finding::dead_encoder);
}

}  // namespace
}  // namespace stilt::commissioning
