#include "mpc_core/control/fall_catcher.h"

#include <gtest/gtest.h>

#include <utility>

namespace stilt::control {
namespace {

using gait::Fall;
using gait::GaitKind;

constexpr double kLongStanding_s = 10.0;
constexpr double kPlan_s = 0.01;
const model::FeetVector kFeet{0.15, 0.0, -0.15, 0.0};

/// Speed of the base that counts as moving.
constexpr double kFast_m_s = 0.5;

class FallCatcherTest : public ::testing::Test {
 protected:
  GaitKind after(double time_s, double capture_x_m, double standing_s, GaitKind command = GaitKind::stand,
                 double base_m_s = kFast_m_s) {
    return catcher_.update(time_s, {command, 0.3}, standing_s, base_m_s, capture_x_m, kFeet, parameters_)
        .kind;
  }

  gait::GaitParameters parameters_;
  FallCatcher catcher_;
};

TEST_F(FallCatcherTest, StepsBeginWhenTheCapturePointComesWithinTheMarginOfTheFeet) {
  const double edge_m = 0.15 - parameters_.catch_margin_m;
  for (const auto& [side, fall] : {std::pair{1.0, Fall::forward}, std::pair{-1.0, Fall::backward}}) {
    catcher_.reset();
    EXPECT_EQ(after(0.0, side * (edge_m - 1e-6), kLongStanding_s), GaitKind::stand);
    EXPECT_EQ(catcher_.fall(), Fall::none);
    EXPECT_EQ(after(0.01, side * (edge_m + 1e-6), kLongStanding_s), GaitKind::step);
    EXPECT_EQ(catcher_.fall(), fall);
  }
}

TEST_F(FallCatcherTest, StandsAgainAfterAStepWithoutSpeed) {
  double time_s = 0.0;
  ASSERT_EQ(after(time_s, 1.0, kLongStanding_s), GaitKind::step);
  for (; time_s < 1.0; time_s += kPlan_s) ASSERT_EQ(after(time_s, 1.0, 0.0), GaitKind::step);
  const double slow_since_s = time_s - kPlan_s;
  while (after(time_s, 0.0, 0.0, GaitKind::stand, 0.9 * parameters_.catch_calm_m_s) == GaitKind::step) {
    time_s += kPlan_s;
  }
  EXPECT_NEAR(time_s - slow_since_s, parameters_.single_support_s, 1.5 * kPlan_s);
  EXPECT_EQ(catcher_.fall(), Fall::none);
}

TEST_F(FallCatcherTest, DoesNotStartWhileFeetMoveNorRightAfterALanding) {
  EXPECT_EQ(after(0.0, 2.0, 0.0), GaitKind::stand);
  EXPECT_EQ(after(0.0, 2.0, 0.01), GaitKind::stand);
}

TEST_F(FallCatcherTest, TheOperatorsStepsAndWalkPassUnchangedAndEndACatch) {
  ASSERT_EQ(after(0.0, 1.0, kLongStanding_s), GaitKind::step);
  EXPECT_EQ(after(0.01, 1.0, 0.0, GaitKind::walk), GaitKind::walk);
  EXPECT_EQ(catcher_.fall(), Fall::none);
}

TEST_F(FallCatcherTest, SwitchedOffItPassesEveryCommand) {
  parameters_.catch_falls = false;
  EXPECT_EQ(after(0.0, 5.0, kLongStanding_s), GaitKind::stand);
}

}  // namespace
}  // namespace stilt::control
