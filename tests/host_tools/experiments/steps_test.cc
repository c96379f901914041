#include "host_tools/experiments/steps.h"

#include <gtest/gtest.h>

#include <vector>

namespace stilt::experiments {
namespace {

constexpr double kStep_s = 0.3;

/// Touch-downs 0.3 s apart from 0 s on; the hip moves from each to the next with the speed in the list.
std::vector<log::Step> walk_with(const std::vector<double>& speeds_m_s) {
  std::vector<log::Step> steps = {{0.0, "L", 0.1, 0.0}};
  for (const double speed_m_s : speeds_m_s) {
    const log::Step& last = steps.back();
    steps.push_back(
        {last.time_s + kStep_s, last.foot == "L" ? "R" : "L", 0.1, last.hip_x_m + kStep_s * speed_m_s});
  }
  return steps;
}

TEST(StepRange, CountsStepsThatLandFromATimeOn) {
  const std::vector<log::Step> steps = {{1.0, "L", 0.9, 0.0}, {2.0, "R", 0.2, 0.0}, {3.0, "L", -0.1, 0.0}};
  const auto range = step_range(steps, 2.0);
  ASSERT_TRUE(range.has_value());
  EXPECT_EQ(range->min_m, -0.1);
  EXPECT_EQ(range->max_m, 0.2);
  EXPECT_FALSE(step_range(steps, 3.1).has_value());
}

TEST(Recovery, TakesNoStepWhenThePushDidNotChangeTheSpeed) {
  EXPECT_EQ(recovery_steps(walk_with(std::vector(10, 0.52)), 0.4, 0.5), 0);
}

TEST(Recovery, CountsTheTouchDownsUntilTheSpeedIsBack) {
  // The push ends at 0.4 s, between touch-downs 0 (0.3 s) and 1 (0.6 s). The steps from touch-downs 0 and 1
  // are too fast, so the first two steps of the usual speed begin at touch-down 2.
  EXPECT_EQ(recovery_steps(walk_with({0.5, 0.9, 0.8, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}), 0.4, 0.5), 2);
}

TEST(Recovery, TakesTheMeanOverTwoSteps) {
  EXPECT_EQ(recovery_steps(walk_with({0.5, 0.6, 0.4, 0.6, 0.4, 0.6, 0.4, 0.6}), 0.4, 0.5), 0)
      << "a limping walk of the right speed";
}

TEST(Recovery, CountsFromTheLastTouchDownThatIsNotAfterThePush) {
  const auto walk = walk_with({0.5, 0.9, 0.8, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5});
  EXPECT_EQ(recovery_steps(walk, 0.6, 0.5), 1) << "a touch-down with the end of the push is touch-down 0";
  EXPECT_EQ(recovery_steps(walk, 0.59, 0.5), 2);
}

TEST(Recovery, AsksForFourTouchDownsInARow) {
  // Back at touch-downs 1 to 3, but not at 4 and 5: the step after touch-down 5 is too fast.
  const std::vector<double> speeds_m_s = {0.9, 0.5, 0.5, 0.5, 0.5, 0.9, 0.5, 0.5, 0.5, 0.5, 0.5};
  EXPECT_EQ(recovery_steps(walk_with(speeds_m_s), 0.1, 0.5), 6);
  EXPECT_FALSE(recovery_steps(walk_with({0.9, 0.5, 0.5, 0.5, 0.5}), 0.1, 0.5).has_value())
      << "the walk ends before the fourth";
  EXPECT_EQ(recovery_steps(walk_with({0.9, 0.5, 0.5, 0.5, 0.5, 0.5}), 0.1, 0.5), 1);
}

TEST(Recovery, IsWithinTenPercentOfTheUnpushedSpeed) {
  EXPECT_EQ(recovery_steps(walk_with(std::vector(10, 0.77)), 0.4, 0.7), 0);
  EXPECT_FALSE(recovery_steps(walk_with(std::vector(10, 0.78)), 0.4, 0.7).has_value());
  EXPECT_FALSE(recovery_steps(walk_with(std::vector(10, 0.62)), 0.4, 0.7).has_value());
}

TEST(Recovery, IsWithinThreeCentimetresASecondOfAStepInPlace) {
  EXPECT_EQ(recovery_steps(walk_with(std::vector(10, -0.029)), 0.4, 0.0), 0);
  EXPECT_FALSE(recovery_steps(walk_with(std::vector(10, 0.031)), 0.4, 0.0).has_value());
}

TEST(Recovery, OfARobotThatDoesNotStepIsUnknown) {
  EXPECT_FALSE(recovery_steps({}, 0.4, 0.0).has_value());
  EXPECT_FALSE(recovery_steps(walk_with(std::vector(10, 0.5)), -0.1, 0.5).has_value())
      << "no touch-down before the end of the push to count from";
}

}  // namespace
}  // namespace stilt::experiments
