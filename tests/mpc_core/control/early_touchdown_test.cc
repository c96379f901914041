#include <gtest/gtest.h>

#include "mpc_core/control/estimator.h"
#include "tests/mpc_core/control/relative_feet.h"
#include "tests/mpc_core/control/sample_plan.h"
#include "tests/robots.h"

/// A foot that reaches the ground before its scheduled touch-down.
namespace stilt::control {
namespace {

using model::ContactMode;
using model::kFirstJoint;
using model::kLeft;
using model::kPositions;
using model::kRight;
using model::StateVector;
using testing_support::reading_of;
using testing_support::RelativeFeet;

constexpr double kTick_s = 0.001;
constexpr double kExact = 1e-9;
constexpr ContactMode kLeftOnly{true, false};
constexpr ContactMode kRightOnly{false, true};

/// The left foot is scheduled to stand; the knees bend and stretch.
class EarlyTouchdownTest : public ::testing::Test {
 protected:
  void SetUp() override {
    estimator_.configure(robot_, {.blend_s = 0.0});
    estimator_.reset(reading_of(with_knees(0.5, 0.5), 0.0), 0.0);
  }
  [[nodiscard]] static StateVector with_knees(double left_rad, double right_rad) {
    StateVector state = StateVector::Zero();
    state[kFirstJoint] = -0.5 * left_rad;
    state[kFirstJoint + 1] = left_rad;
    state[kFirstJoint + 2] = -0.5 * right_rad;
    state[kFirstJoint + 3] = right_rad;
    state[kPositions + kFirstJoint + 1] = -1.0;  // both knees stretch, at different speeds of the feet
    state[kPositions + kFirstJoint + 3] = -2.0;
    return state;
  }
  [[nodiscard]] StateVector after(const StateVector& state, ContactMode contact) {
    time_s_ += kTick_s;
    return estimator_.update(reading_of(state, time_s_), contact);
  }
  void expect_carried_by(int foot, const StateVector& state, const StateVector& estimate) const {
    const RelativeFeet feet(robot_, state);
    EXPECT_NEAR(estimate[1], feet.height_m(foot), kExact);
    EXPECT_NEAR(estimate[kPositions + 1], feet.vz_m_s(foot), kExact);
    EXPECT_NEAR(estimate[kPositions], feet.vx_m_s(kLeft), kExact) << "that of the scheduled foot";
  }

  const model::RobotModel& robot_ = testing_support::amber3m();
  Estimator estimator_;
  const StateVector lifted_ = with_knees(0.5, 0.9);
  const StateVector lower_ = with_knees(0.5, 0.45);
  double time_s_ = 0.0;
};

TEST_F(EarlyTouchdownTest, ASwingFootThatComesBelowTheStanceFootCarries) {
  expect_carried_by(kLeft, lifted_, after(lifted_, kLeftOnly));
  expect_carried_by(kRight, lower_, after(lower_, kLeftOnly));
  expect_carried_by(kRight, lifted_, after(lifted_, kLeftOnly));  // the stance foot flies up
}

TEST_F(EarlyTouchdownTest, AFootThatHasNotLeftTheGroundHasNotLanded) {
  expect_carried_by(kLeft, lower_, after(lower_, kLeftOnly));
}

TEST_F(EarlyTouchdownTest, TheScheduleCountsAgainOnceItChanges) {
  (void)after(lifted_, kLeftOnly);
  (void)after(lower_, kLeftOnly);
  (void)after(lower_, kRightOnly);
  expect_carried_by(kLeft, lower_, after(lower_, kLeftOnly));
}

TEST_F(EarlyTouchdownTest, TheHeightIsContinuousWhereTheFootThatLandedIsScheduledToLand) {
  for (const ContactMode& next : {kRightOnly, ContactMode{true, true}}) {
    estimator_.configure(robot_, {.blend_s = 0.02});
    estimator_.reset(reading_of(with_knees(0.5, 0.5), 0.0), 0.0);
    time_s_ = 0.1;
    for (int tick = 0; tick < 30; ++tick) (void)after(lifted_, kLeftOnly);
    const StateVector before = after(lower_, kLeftOnly);
    const StateVector at_switch = after(lower_, next);
    EXPECT_NEAR(before[1], RelativeFeet(robot_, lower_).height_m(kRight), kExact);
    EXPECT_NEAR(at_switch[0], before[0], kExact);
    EXPECT_NEAR(at_switch[1], before[1], kExact);
  }
}

TEST_F(EarlyTouchdownTest, AMillimetreIsNoise) {
  const StateVector nearly = with_knees(0.5, 0.49);
  const RelativeFeet feet(robot_, nearly);
  ASSERT_GT(feet.height_m(kRight) - feet.height_m(kLeft), 0.0005);
  (void)after(lifted_, kLeftOnly);
  expect_carried_by(kLeft, nearly, after(nearly, kLeftOnly));
}

}  // namespace
}  // namespace stilt::control
