#include "mpc_core/gait/swing.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stilt::gait {
namespace {

constexpr double kDuration_s = 0.4;
constexpr double kStep = 1e-5;

TEST(MinimumJerk, StartsAndEndsAtRestWithoutAcceleration) {
  const Motion start = minimum_jerk(0.1, 0.35, 0.0, kDuration_s);
  EXPECT_EQ(start.position, 0.1);
  EXPECT_EQ(start.velocity, 0.0);
  EXPECT_EQ(start.acceleration, 0.0);
  const Motion end = minimum_jerk(0.1, 0.35, 1.0, kDuration_s);
  EXPECT_NEAR(end.position, 0.35, 1e-15);
  EXPECT_NEAR(end.velocity, 0.0, 1e-14);
  EXPECT_NEAR(end.acceleration, 0.0, 1e-12);
}

TEST(MinimumJerk, IsHalfWayAtHalfTimeAndNeverTurnsBack) {
  EXPECT_NEAR(minimum_jerk(-0.2, 0.4, 0.5, kDuration_s).position, 0.1, 1e-15);
  for (double s = 0.01; s < 1.0; s += 0.01) EXPECT_GT(minimum_jerk(-0.2, 0.4, s, kDuration_s).velocity, 0.0);
}

TEST(SwingHeight, RisesFromRestOnTheGroundAndMeetsItWithTheTouchDownVelocity) {
  for (const double velocity_m_s : {0.0, -0.05, -0.2, -0.4}) {
    const Motion start = swing_height(0.06, velocity_m_s, 0.0, kDuration_s);
    EXPECT_EQ(start.position, 0.0);
    EXPECT_EQ(start.velocity, 0.0);
    const Motion end = swing_height(0.06, velocity_m_s, 1.0, kDuration_s);
    EXPECT_NEAR(end.position, 0.0, 1e-15);
    EXPECT_NEAR(end.velocity, velocity_m_s, 1e-15);
  }
}

TEST(SwingHeight, IsAtTheApexAtHalfTime) {
  for (const double velocity_m_s : {0.0, -0.2, -0.4}) {
    EXPECT_NEAR(swing_height(0.06, velocity_m_s, 0.5, kDuration_s).position, 0.06, 1e-15);
  }
}

TEST(SwingHeight, StaysAboveGroundAndCloseToTheApexAtItsHighest) {
  double highest_m = 0.0;
  for (double s = 0.005; s < 1.0; s += 0.005) {
    const double height_m = swing_height(0.06, -0.2, s, kDuration_s).position;
    EXPECT_GT(height_m, 0.0);
    highest_m = std::max(highest_m, height_m);
  }
  EXPECT_LT(highest_m, 1.01 * 0.06);  // a little after half time the foot is still rising
}

TEST(Swing, VelocityAndAccelerationAreDerivativesInTime) {
  const auto check = [](const auto& profile) {
    for (double s = 0.02; s < 1.0; s += 0.037) {
      const Motion now = profile(s);
      const Motion later = profile(s + kStep / kDuration_s);
      const Motion earlier = profile(s - kStep / kDuration_s);
      EXPECT_NEAR(now.velocity, (later.position - earlier.position) / (2.0 * kStep), 1e-7);
      EXPECT_NEAR(now.acceleration, (later.velocity - earlier.velocity) / (2.0 * kStep), 1e-6);
    }
  };
  check([](double s) { return minimum_jerk(-0.1, 0.3, s, kDuration_s); });
  check([](double s) { return swing_height(0.06, -0.2, s, kDuration_s); });
  check([](double s) { return swing_height(0.10, 0.0, s, kDuration_s); });
}

}  // namespace
}  // namespace stilt::gait
