#include "host_tools/experiments/periodicity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stilt::experiments {
namespace {

/// Steps of 0.4 s, L and R in turn, whose joint angles swing with an amplitude that differs from step to step
/// by +-spread_rad.
log::RunRecord steps_with(double spread_rad) {
  constexpr double kStep_s = 0.4;
  log::RunRecord record;
  for (int i = 0; i <= 2000; ++i) {
    log::RunSample sample;
    sample.time_s = 0.005 * i;
    const int step = static_cast<int>(sample.time_s / kStep_s + 1e-9);
    const double share = sample.time_s / kStep_s - step;
    const double amplitude_rad = 0.5 + ((step / 2) % 2 == 0 ? spread_rad : -spread_rad);
    const double stance_rad = amplitude_rad * std::sin(std::numbers::pi * share);
    const int stance = step % 2;
    sample.true_state.setZero();
    for (int joint = 0; joint < 2; ++joint) {
      sample.true_state[model::kFirstJoint + 2 * stance + joint] = stance_rad;
      sample.true_state[model::kFirstJoint + 2 * (1 - stance) + joint] = -stance_rad;
    }
    record.samples.push_back(sample);
  }
  for (int step = 0; step * kStep_s < 10.0; ++step) {
    record.summary.steps.push_back({step * kStep_s, step % 2 == 0 ? "L" : "R", 0.2});
  }
  return record;
}

TEST(Periodicity, OfEqualStepsIsNought) {
  const Periodicity result = periodicity(steps_with(0.0), 1.0);
  EXPECT_EQ(result.steps, 21);
  EXPECT_NEAR(result.rms_rad, 0.0, 2e-3) << "but for the samples at a touch-down";
}

TEST(Periodicity, IsTheStandardDeviationOverSteps) {
  const Periodicity result = periodicity(steps_with(0.05), 1.0);
  // Amplitudes 0.5 +- 0.05, half of the steps each: standard deviation 0.05 |sin|, whose square's mean is
  // 1/2.
  EXPECT_NEAR(result.largest_rad, 0.05, 0.003);
  EXPECT_NEAR(result.rms_rad, 0.05 / std::sqrt(2.0), 0.003);
}

/// Two steps of a ramp, the second twice as long and 0.1 rad higher at the end of its first joint. At share u
/// the joint of the stance leg is u and 1.1 u.
TEST(Periodicity, OfTwoStepsIsTheirDifferenceOverTheRootOfTwoAtTheSameShare) {
  log::RunRecord record;
  const auto add = [&record](double time_s, int stance, double angle_rad) {
    log::RunSample& sample = record.samples.emplace_back();
    sample.time_s = time_s;
    sample.true_state.setZero();
    sample.true_state[model::kFirstJoint + 2 * stance] = angle_rad;
  };
  for (int i = 0; i < 1000; ++i) add(0.0004 * i, 0, 0.001 * i);
  for (int i = 0; i <= 1000; ++i) add(0.4 + 0.0008 * i, 1, 0.0011 * i);
  record.summary.steps = {{0.0, "L", 0.2}, {0.4, "R", 0.2}, {1.2, "L", 0.2}};
  const Periodicity result = periodicity(record, 0.0);
  ASSERT_EQ(result.steps, 2);
  EXPECT_NEAR(result.largest_rad, 0.1 * 0.98 / std::sqrt(2.0), 1e-9) << "shares end at 49 / 50";
  double squares = 0.0;
  for (int i = 0; i < 50; ++i) squares += 0.5 * std::pow(0.1 * i / 50.0, 2);
  EXPECT_NEAR(result.rms_rad, std::sqrt(squares / (4 * 50)), 1e-9);
}

TEST(Periodicity, StepsBeforeTheTimeAskedForAndOfOneFootTwiceAreLeftOut) {
  log::RunRecord record = steps_with(0.05);
  EXPECT_EQ(periodicity(record, 0.8).steps, 22);
  EXPECT_EQ(periodicity(record, 0.8 + 1e-6).steps, 21);
  record.summary.steps[10].foot = record.summary.steps[9].foot;
  EXPECT_EQ(periodicity(record, 0.8).steps, 20);
}

TEST(Periodicity, OfFewerThanTwoStepsIsUnknown) {
  EXPECT_EQ(periodicity(steps_with(0.1), 9.5).rms_rad, 0.0);
  EXPECT_EQ(periodicity({}, 0.0).steps, 0);
}

}  // namespace
}  // namespace stilt::experiments
