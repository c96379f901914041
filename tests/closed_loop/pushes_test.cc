#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "host_tools/experiments/steps.h"
#include "tests/closed_loop/simulated_run.h"

namespace stilt::simulation {
namespace {

using testing_support::describe;
using testing_support::RunRequest;
using testing_support::SimulatedRun;

constexpr int kPhases = 8;
constexpr double kPush_N = 40.0;
constexpr double kPush_s = 1.0;

/// Phase of the step at which the push begins, and horizon.
class Pushes : public ::testing::TestWithParam<std::tuple<int, double>> {};

/// A walk with one push; `start_s` becomes its beginning.
RunRequest pushed_walk(int phase, double horizon_s, double push_N, double& start_s) {
  RunRequest request = testing_support::walking(0.5, horizon_s, 14.0);
  const gait::GaitParameters gait = testing_support::parameters_of(request).gait;
  const double step_s = gait.single_support_s + gait.double_support_s;
  // Steps begin at whole step times after the first lift-off; the odd phases push on the other foot.
  const int step = 12 + phase % 2;
  start_s = gait.switch_lead_s + step_s * (step + static_cast<double>(phase) / kPhases);
  request.pushes = {{push_N, start_s, kPush_s, PushPoint::hip}};
  return request;
}

TEST_P(Pushes, SurvivesFortyNewtonsForASecondAndGoesOnWalking) {
  const auto [phase, horizon_s] = GetParam();
  double start_s = 0.0;
  RunRequest request = pushed_walk(phase, horizon_s, kPush_N, start_s);
  request.keep_samples = true;
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << "pushed at " << start_s << " s: " << describe(run, record);

  // Undisturbed walking again in the last three seconds.
  const log::RunSample& end = record.samples.back();
  const log::RunSample& before = record.samples[record.samples.size() - 600];
  EXPECT_NEAR((end.true_state[0] - before.true_state[0]) / (end.time_s - before.time_s), 0.5, 0.1);
}

TEST_P(Pushes, IsBackAtItsSpeedTwoStepsAfterTwentyNewtons) {
  const auto [phase, horizon_s] = GetParam();
  double start_s = 0.0;
  SimulatedRun run(pushed_walk(phase, horizon_s, 20.0, start_s));
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << describe(run, record);
  const auto steps = experiments::recovery_steps(record.summary.steps, start_s + kPush_s, 0.5);
  ASSERT_TRUE(steps.has_value()) << "pushed at " << start_s << " s";
  EXPECT_LE(*steps, 2) << "pushed at " << start_s << " s";
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, Pushes,
                         ::testing::Combine(::testing::Range(0, kPhases), ::testing::Values(1.0, 2.0)),
                         [](const auto& test) {
                           return "Phase" + std::to_string(std::get<0>(test.param)) + "Horizon" +
                                  std::to_string(static_cast<int>(std::get<1>(test.param)));
                         });

/// 85 % of the forces of docs/decisions/0036-five-hundred-plans-per-second.md, with the noise of the
/// experiments.
struct GuardedPush {
  const char* name;
  double push_N;
  PushPoint point;
};

class ShippedPushes : public ::testing::TestWithParam<std::tuple<GuardedPush, int>> {};

TEST_P(ShippedPushes, AreSurvivedAt85PercentOfTheirForce) {
  const auto& [push, phase] = GetParam();
  double start_s = 0.0;
  RunRequest request = pushed_walk(2 * phase, 1.0, 0.85 * push.push_N, start_s);
  request.pushes.front().point = push.point;
  request.plant = {"encoder_noise_rad=0.0005", "encoder_velocity_noise_rad_s=0.02",
                   "base_pitch_noise_rad=0.001", "base_pitch_rate_noise_rad_s=0.01"};
  request.seed = static_cast<std::uint64_t>(phase) + 1;
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  EXPECT_TRUE(record.summary.survived) << "pushed at " << start_s << " s: " << describe(run, record);
}

INSTANTIATE_TEST_SUITE_P(
    ClosedLoop, ShippedPushes,
    ::testing::Combine(::testing::Values(GuardedPush{"HipForward", 150.0, PushPoint::hip},
                                         GuardedPush{"HipBackward", -130.0, PushPoint::hip},
                                         GuardedPush{"TorsoForward", 90.0, PushPoint::torso},
                                         GuardedPush{"TorsoBackward", -85.0, PushPoint::torso}),
                       ::testing::Range(0, 4)),
    [](const auto& test) {
      return std::string(std::get<0>(test.param).name) + "Phase" +
             std::to_string(2 * std::get<1>(test.param));
    });

/// docs/decisions/0037-feasible-plans.md: with the true velocity of a base in flight none of eight survived.
class KnownState : public ::testing::TestWithParam<int> {};

TEST_P(KnownState, SurvivesWhatTheEstimateSurvives) {
  double start_s = 0.0;
  RunRequest request = pushed_walk(2 * GetParam(), 1.0, 0.85 * 150.0, start_s);
  request.use_true_state = true;
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  EXPECT_TRUE(record.summary.survived) << "pushed at " << start_s << " s: " << describe(run, record);
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, KnownState, ::testing::Range(0, 4));

}  // namespace
}  // namespace stilt::simulation
