#include <gtest/gtest.h>

#include <random>
#include <tuple>

#include "tests/closed_loop/simulated_run.h"

/// A standing robot steps when a push would fell it, and stands again; it does not step without need.
namespace stilt::simulation {
namespace {

using testing_support::describe;
using testing_support::RunRequest;
using testing_support::SimulatedRun;

const std::vector<std::string> kSensorNoise = {
    "encoder_noise_rad=0.0005", "encoder_velocity_noise_rad_s=0.02", "base_pitch_noise_rad=0.001",
    "base_pitch_rate_noise_rad_s=0.01"};

RunRequest standing(double duration_s, const Push& push, std::uint64_t seed) {
  return {.plant = kSensorNoise,
          .commands = {{0.0, {gait::GaitKind::stand, 0.0}}},
          .pushes = {push},
          .duration_s = duration_s,
          .seed = seed};
}

/// Force at the hip, N, and start of the push, s.
class StandingPushes : public ::testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(StandingPushes, EndInStandingWithinThreeSeconds) {
  const auto [force_N, start_s] = GetParam();
  constexpr double kPush_s = 1.0;
  constexpr double kRecovered_s = 3.0;
  constexpr double kStands_s = 2.0;
  for (const std::uint64_t seed : {1, 2}) {
    const Push push{force_N, start_s, kPush_s, PushPoint::hip};
    SimulatedRun run(standing(start_s + kPush_s + kRecovered_s + kStands_s, push, seed));
    const log::RunRecord record = run.run();
    ASSERT_TRUE(record.summary.survived) << "seed " << seed << ": " << describe(run, record);
    ASSERT_FALSE(record.summary.steps.empty()) << "seed " << seed;
    EXPECT_LT(record.summary.steps.back().time_s, start_s + kPush_s + kRecovered_s) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, StandingPushes,
                         ::testing::Combine(::testing::Values(-85.0, -50.0, 50.0, 85.0),
                                            ::testing::Values(2.0, 2.13)));

TEST(Standing, TenNewtonsForAMinuteNeedNoStep) {
  for (const double force_N : {-10.0, 10.0}) {
    SimulatedRun run(standing(60.0, {force_N, 2.0, 57.0, PushPoint::hip}, 3));
    const log::RunRecord record = run.run();
    ASSERT_TRUE(record.summary.survived) << force_N << " N: " << describe(run, record);
    EXPECT_TRUE(record.summary.steps.empty()) << force_N << " N: " << describe(run, record);
  }
}

TEST(Standing, TenMinutesOfPushesOfTenNewtonsNeedNoStep) {
  constexpr std::uint32_t kSeed = 1;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> pause_s(3.0, 7.0);
  RunRequest request = standing(600.0, {10.0, 4.0, 1.0, PushPoint::hip}, kSeed);
  for (double start_s = 8.0; start_s < 595.0; start_s += pause_s(random)) {
    const double force_N = random() % 2 == 0 ? 10.0 : -10.0;
    request.pushes.push_back({force_N, start_s, 1.0, random() % 2 == 0 ? PushPoint::hip : PushPoint::torso});
  }
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << "seed " << kSeed << ": " << describe(run, record);
  EXPECT_TRUE(record.summary.steps.empty()) << "seed " << kSeed << ": " << describe(run, record);
}

}  // namespace
}  // namespace stilt::simulation
