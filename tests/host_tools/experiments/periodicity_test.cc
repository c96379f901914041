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

TEST(Periodicity, OfFewerThanTwoStepsIsUnknown) {
  EXPECT_EQ(periodicity(steps_with(0.1), 9.5).rms_rad, 0.0);
  EXPECT_EQ(periodicity({}, 0.0).steps, 0);
}

}  // namespace
}  // namespace stilt::experiments
