#include "firmware/commissioning/wiring_verdict.h"

#include <gtest/gtest.h>

namespace stilt::commissioning {
namespace {

constexpr std::size_t kHipLeft = 0, kKneeLeft = 1;
constexpr double kDegree = 3.14159265358979 / 180;

Sighting seen(std::size_t link, Way way, double angle_deg) { return {link, way, angle_deg * kDegree}; }

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
