#include "mpc_core/control/fall_catcher.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stilt::control {
namespace {

using gait::Fall;
using gait::GaitKind;

constexpr double kHeight_m = 0.8;
constexpr double kLongStanding_s = 10.0;
constexpr double kPlan_s = 0.01;
const model::FeetVector kFeet{0.15, 0.0, -0.15, 0.0};

model::StateVector base(double x_m, double vx_m_s) {
  model::StateVector state = model::StateVector::Zero();
  state[0] = x_m;
  state[1] = kHeight_m;
  state[model::kPositions] = vx_m_s;
  return state;
}

/// Speed at which the capture point of a hip between the feet is this far ahead.
double speed_for(double capture_x_m) { return capture_x_m * std::sqrt(model::kGravity_m_s2 / kHeight_m); }

class FallCatcherTest : public ::testing::Test {
 protected:
  GaitKind after(double time_s, double vx_m_s, double standing_s, GaitKind command = GaitKind::stand) {
    return catcher_.update(time_s, {command, 0.3}, standing_s, base(0.0, vx_m_s), kFeet, parameters_).kind;
  }

  gait::GaitParameters parameters_;
  FallCatcher catcher_;
};

TEST_F(FallCatcherTest, StepsBeginWhenTheCapturePointComesWithinTheMarginOfTheFeet) {
  const double edge_m = 0.15 - parameters_.catch_margin_m;
  for (const auto& [side, fall] : {std::pair{1.0, Fall::forward}, std::pair{-1.0, Fall::backward}}) {
    catcher_.reset();
    EXPECT_EQ(after(0.0, speed_for(side * (edge_m - 1e-6)), kLongStanding_s), GaitKind::stand);
    EXPECT_EQ(catcher_.fall(), Fall::none);
    EXPECT_EQ(after(0.01, speed_for(side * (edge_m + 1e-6)), kLongStanding_s), GaitKind::step);
    EXPECT_EQ(catcher_.fall(), fall);
  }
}

TEST_F(FallCatcherTest, StandsAgainAfterAStepWithoutSpeed) {
  double time_s = 0.0;
  ASSERT_EQ(after(time_s, 1.0, kLongStanding_s), GaitKind::step);
  for (; time_s < 1.0; time_s += kPlan_s) ASSERT_EQ(after(time_s, 0.5, 0.0), GaitKind::step);
  const double slow_since_s = time_s - kPlan_s;
  while (after(time_s, 0.9 * parameters_.catch_calm_m_s, 0.0) == GaitKind::step) time_s += kPlan_s;
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
