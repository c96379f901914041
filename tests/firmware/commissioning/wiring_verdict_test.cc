#include "firmware/commissioning/wiring_verdict.h"

#include <gtest/gtest.h>

namespace stilt::commissioning {
namespace {

using configuration::DriverParameters;
using configuration::DriverProtocol;

constexpr std::size_t kHipLeft = 0, kKneeLeft = 1;
constexpr double kDegree = 3.14159265358979 / 180;

JogMotion completed(double reached_rad, double leg_reached_rad, double velocity_factor = 1) {
  JogMotion motion;
  motion.response = Response::with_torque;
  motion.direction = reached_rad > 0 ? 1 : -1;
  motion.reached_rad = reached_rad;
  motion.leg_reached_rad = leg_reached_rad;
  motion.velocity_factor = velocity_factor;
  motion.completed = true;
  return motion;
}

Sighting seen(std::size_t link, Way way, double angle_deg) { return {link, way, angle_deg * kDegree}; }

/// The limp thigh of a RABBIT gives way by more than a quarter of its knee's motion. 0.3 rad of the knee turn
/// the shin by 12.5 degrees.
TEST(WiringVerdict, AShinThatTurnsLessThanItsKneeHasTheRightGear) {
  for (const double angle_deg : {9.5, 12.0, 17.0}) {
    const Sighting back = seen(kKneeLeft, Way::backward, angle_deg);
    EXPECT_EQ(judge(kKneeLeft, completed(0.3, -0.082), back, {}).finding, Finding::correct) << angle_deg;
    const Sighting forth = seen(kKneeLeft, Way::forward, angle_deg);
    EXPECT_EQ(judge(kKneeLeft, completed(-0.3, 0.082), forth, {}).finding, Finding::correct) << angle_deg;
  }
}

/// The same motions, read with half and with twice the ratio of the knee.
TEST(WiringVerdict, TheRatioOfAKneeIsFoundBesideAThighThatGivesWay) {
  const Verdict half = judge(kKneeLeft, completed(0.15, -0.082), seen(kKneeLeft, Way::backward, 12.5), {});
  EXPECT_EQ(half.finding, Finding::wrong_ratio);
  EXPECT_NE(half.sentence.find("encoders of hip_L and knee_L report 4; the ratio is about 0.5, and"),
            std::string::npos)
      << half.sentence;
  const Verdict twice = judge(kKneeLeft, completed(-0.6, 0.082), seen(kKneeLeft, Way::forward, 12.5), {});
  EXPECT_EQ(twice.finding, Finding::wrong_ratio);
  EXPECT_NE(twice.sentence.find("the ratio is about 2, and the configuration has 1"), std::string::npos)
      << twice.sentence;
}

TEST(WiringVerdict, AThighTurnsWithItsHip) {
  const Sighting back = seen(kHipLeft, Way::backward, 17);
  EXPECT_EQ(judge(kHipLeft, completed(0.3, -0.3), back, {}).finding, Finding::correct);
  const Verdict half = judge(kHipLeft, completed(0.15, -0.3), back, {});
  EXPECT_EQ(half.finding, Finding::wrong_ratio);
  EXPECT_NE(half.sentence.find("where the encoder of hip_L reports 9; the ratio is about 0.506"),
            std::string::npos)
      << half.sentence;
}

std::string wrong_speed(std::size_t joint, const DriverParameters& driver, double factor) {
  Sighting not_measured = seen(joint, Way::backward, 0);
  not_measured.angle_rad.reset();
  const Verdict verdict = judge(joint, completed(0.3, 0, factor), not_measured, driver);
  EXPECT_EQ(verdict.finding, Finding::wrong_speed) << verdict.sentence;
  return verdict.sentence;
}

TEST(WiringVerdict, AVelocityThatIsNotThatOfThePositionNamesTheKeysOfTheDriver) {
  const DriverParameters ak{.protocol = DriverProtocol::mit_ak, .velocity_range_rad_s = 20};
  EXPECT_EQ(
      wrong_speed(kKneeLeft, ak, 0.5),
      "wrong speed: velocities of knee_L are 0.50 times those of its positions; velocity_range_rad_s of "
      "knee_driver is 20, and right would be about 40 (where position_range_rad is right)");
  const DriverParameters ak3{
      .protocol = DriverProtocol::ak_v3, .ak_v3_pole_pairs = 21, .ak_v3_gear_ratio = 9};
  EXPECT_EQ(wrong_speed(kHipLeft, ak3, 2.0 / 3),
            "wrong speed: velocities of hip_L are 0.67 times those of its positions; ak_v3_pole_pairs times "
            "ak_v3_gear_ratio of hip_driver is 189, and right would be about 126");
  for (const DriverProtocol protocol : {DriverProtocol::moteus, DriverProtocol::odrive}) {
    EXPECT_TRUE(wrong_speed(kHipLeft, {.protocol = protocol}, -1)
                    .ends_with("look at the velocity filter and the encoders of its driver"));
  }
}

TEST(WiringVerdict, AVelocityWithinAFifthIsCorrect) {
  for (const double factor : {0.9, 1.1}) {
    const Verdict verdict = judge(kHipLeft, completed(0.3, 0, factor), seen(kHipLeft, Way::backward, 17), {});
    EXPECT_EQ(verdict.finding, Finding::correct) << verdict.sentence;
  }
}

/// The eye agrees with the velocities.
TEST(WiringVerdict, AWrongRangeOfPositionsIsNamedWhereItLooksLikeAGear) {
  const Sighting back = seen(kHipLeft, Way::backward, 34);
  const Verdict range = judge(kHipLeft, completed(0.3, 0, 2), back, {.protocol = DriverProtocol::mit_ak});
  EXPECT_EQ(range.finding, Finding::wrong_ratio);
  EXPECT_TRUE(range.sentence.ends_with("first look at position_range_rad of hip_driver")) << range.sentence;
  const Verdict gear = judge(kHipLeft, completed(0.3, 0), back, {.protocol = DriverProtocol::mit_ak});
  EXPECT_EQ(gear.sentence.find("position_range_rad"), std::string::npos) << gear.sentence;
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
  EXPECT_EQ(judge(kHipLeft, leg_moved(kKneeLeft, 0.06), thigh, {}).finding, Finding::exchanged_encoders);
  EXPECT_EQ(judge(kHipLeft, leg_moved(kKneeLeft, -0.06), thigh, {}).finding, Finding::dead_encoder);
}

}  // namespace
}  // namespace stilt::commissioning
