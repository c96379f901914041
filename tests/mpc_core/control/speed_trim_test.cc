#include "mpc_core/control/speed_trim.h"

#include <gtest/gtest.h>

#include <functional>

namespace stilt::control {
namespace {

constexpr int kPlansPerStep = 30;
constexpr double kPlan_s = 0.01;
constexpr double kStep_s = kPlansPerStep * kPlan_s;
constexpr double kReference_m_s = 0.5;

/// A robot that steps by schedule, at a speed that the test gives for each step.
class SpeedTrimTest : public ::testing::Test {
 protected:
  /// The trim after so many more steps.
  double after_steps(int steps, const std::function<double(int step)>& speed_m_s, bool stepping = true) {
    double trim_m_s = 0.0;
    for (int plan = 0; plan < steps * kPlansPerStep; ++plan, ++plan_) {
      const int step = plan_ / kPlansPerStep;
      trim_m_s = trim_.update({.time_s = plan_ * kPlan_s,
                               .base_x_m = x_m_,
                               .speed_reference_m_s = kReference_m_s,
                               .contact = {step % 2 == 0, step % 2 == 1},
                               .stepping = stepping},
                              parameters_);
      x_m_ += kPlan_s * speed_m_s(step);
    }
    return trim_m_s;
  }
  double after_steps(int steps, double speed_m_s) {
    return after_steps(steps, [speed_m_s](int) { return speed_m_s; });
  }

  gait::ReferenceParameters parameters_;
  SpeedTrim trim_;
  int plan_ = 0;
  double x_m_ = 0.0;
};

TEST_F(SpeedTrimTest, IntegratesASteadyErrorAtEveryTouchdown) {
  constexpr double kError_m_s = 0.02;
  const double before_m_s = after_steps(10, kReference_m_s - kError_m_s);
  const double later_m_s = after_steps(3, kReference_m_s - kError_m_s);
  EXPECT_NEAR(later_m_s - before_m_s, 3.0 * kStep_s * parameters_.speed_trim_1_s * kError_m_s, 1e-12);
  EXPECT_GT(before_m_s, 0.0) << "a slow robot gets a faster reference";
  EXPECT_NEAR(after_steps(10, kReference_m_s), after_steps(10, kReference_m_s), 1e-12) << "and keeps it";
}

TEST_F(SpeedTrimTest, AnErrorCountsUpToTheLargestTrimOnly) {
  const double before_m_s = after_steps(5, 0.0);
  EXPECT_NEAR(after_steps(1, 0.0) - before_m_s,
              kStep_s * parameters_.speed_trim_1_s * parameters_.speed_trim_max_m_s, 1e-12);
}

TEST_F(SpeedTrimTest, StaysAsItIsWhileTheSpeedChanges) {
  (void)after_steps(10, kReference_m_s - 0.02);
  // Over two steps the mean changes by half as much as from step to step.
  const double change_m_s = 2.2 * parameters_.speed_trim_steady_m_s;
  const auto faster = [&](int step) { return kReference_m_s + (step - 9) * change_m_s; };
  const auto slower = [&](int step) { return kReference_m_s + (25 - step) * change_m_s; };
  const double before_m_s = after_steps(1, faster);
  EXPECT_EQ(after_steps(7, faster), before_m_s);
  const double of_the_peak_m_s = kStep_s * parameters_.speed_trim_1_s * parameters_.speed_trim_max_m_s;
  EXPECT_NEAR(after_steps(7, slower), before_m_s, 1.001 * of_the_peak_m_s);
}

TEST_F(SpeedTrimTest, IsBounded) {
  EXPECT_NEAR(after_steps(200, 0.3), parameters_.speed_trim_max_m_s, 1e-12);
  EXPECT_NEAR(after_steps(400, 0.7), -parameters_.speed_trim_max_m_s, 1e-12);
}

TEST_F(SpeedTrimTest, EndsWithTheSteps) {
  ASSERT_GT(after_steps(100, 0.3), 0.1);
  EXPECT_EQ(after_steps(1, [](int) { return 0.0; }, false), 0.0);
  EXPECT_EQ(after_steps(2, 0.3), 0.0) << "nothing is known of the speed yet";
}

}  // namespace
}  // namespace stilt::control
