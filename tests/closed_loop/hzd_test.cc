#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "tests/closed_loop/simulated_run.h"

/// Walking along the shipped gaits: as the reference of the planner, and tracked by the joints alone.
namespace stilt::simulation {
namespace {

using testing_support::describe;
using testing_support::RunRequest;
using testing_support::SimulatedRun;

/// As `stilt sim --controller mpc-hzd`.
RunRequest following(double speed_m_s, double horizon_s, double duration_s) {
  RunRequest request = testing_support::walking(speed_m_s, horizon_s, duration_s);
  request.settings = {"cost.terminal=10",     "cost.terminal_feet=false",  "cost.foot_position=15",
                      "cost.foot_velocity=6", "gait.single_support_s=0.3", "gait.double_support_s=0"};
  request.follow_gaits = true;
  return request;
}

class Speeds : public testing::TestWithParam<double> {};

TEST_P(Speeds, ThePlannerWalksAroundTheGaitsWithAShortHorizon) {
  SimulatedRun run(following(GetParam(), 0.2, 12.0));
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, GetParam(), 0.06) << describe(run, record);
  EXPECT_EQ(record.summary.heap_allocations_in_loop, 0);
}

TEST_P(Speeds, TheJointsAloneTrackTheGaits) {
  RunRequest request = following(GetParam(), 0.5, 15.0);
  request.settings.emplace_back("supervisor.select_gait=true");
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, GetParam(), 0.03) << describe(run, record);
  const auto gait = static_cast<std::size_t>(supervisor::FallbackLevel::gait);
  EXPECT_GT(record.summary.fallback_s[gait], 12.0) << "after two seconds no plan is followed";
  EXPECT_EQ(record.summary.heap_allocations_in_loop, 0);
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, Speeds, testing::Values(-0.4, 0.0, 0.25, 0.5, 1.0),
                         [](const auto& test) {
                           const int centimetres = static_cast<int>(test.param * 100.0);
                           return (centimetres < 0 ? "Backward" : "Forward") +
                                  std::to_string(std::abs(centimetres));
                         });

TEST(ClosedLoop, SpeedsCommandedWhileWalkingAreFollowedFromBackwardToFastAndThroughZero) {
  constexpr double kHold_s = 5.0;
  constexpr double kSpeeds_m_s[] = {0.3, 1.0, 0.4, 0.0, -0.4, 0.1, -0.1, 0.5};
  RunRequest request = following(0.0, 0.5, kHold_s * std::size(kSpeeds_m_s));
  request.commands.clear();
  for (std::size_t i = 0; i < std::size(kSpeeds_m_s); ++i) {
    request.commands.push_back({kHold_s * static_cast<double>(i), {gait::GaitKind::walk, kSpeeds_m_s[i]}});
  }
  request.keep_samples = true;
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << describe(run, record);

  constexpr double kSample_s = 0.005;
  const auto speed_m_s = [&](double from_s, double to_s) {
    const auto at = [&](double t) {
      return record.samples[static_cast<std::size_t>(std::lround(t / kSample_s))];
    };
    return (at(to_s).true_state[0] - at(from_s).true_state[0]) / (to_s - from_s);
  };
  constexpr double kTwoSteps_s = 0.6;
  for (std::size_t i = 0; i < std::size(kSpeeds_m_s); ++i) {
    const double start_s = kHold_s * static_cast<double>(i);
    EXPECT_NEAR(speed_m_s(start_s + 3.0, start_s + 4.8), kSpeeds_m_s[i], 0.05) << "commanded at " << start_s;
    const double before_m_s = i == 0 ? 0.0 : kSpeeds_m_s[i - 1];
    for (double t = start_s + kTwoSteps_s; t + kTwoSteps_s < start_s + kHold_s; t += 0.1) {
      const double now_m_s = speed_m_s(t, t + kTwoSteps_s);
      EXPECT_GT(now_m_s, std::min(before_m_s, kSpeeds_m_s[i]) - 0.1) << "at " << t << " s";
      EXPECT_LT(now_m_s, std::max(before_m_s, kSpeeds_m_s[i]) + 0.1) << "at " << t << " s";
    }
  }
  for (const log::RunSample& sample : record.samples) {
    EXPECT_LT(std::abs(sample.true_state[model::kFirstAngle]), 0.2) << "at " << sample.time_s << " s";
  }
}

class Stops : public testing::TestWithParam<double> {};

/// The gaits land the feet close together, where a stand would step again and again.
TEST_P(Stops, EndInAStandWithTheFeetApart) {
  RunRequest request = following(0.5, 1.0, 12.0);
  request.commands = {{0.0, {gait::GaitKind::walk, 0.5}}, {GetParam(), {gait::GaitKind::stand, 0.0}}};
  request.keep_samples = true;
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_LT(record.summary.steps.back().time_s, GetParam() + 4.0);
  const model::FeetVector& feet = record.samples.back().foot_position_m;
  EXPECT_GT(std::abs(feet[0] - feet[2]), run.parameters.gait.stand_half_width_m);
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, Stops, testing::Values(4.0, 4.07, 4.15, 4.22));

class Pushed : public testing::TestWithParam<int> {};

TEST_P(Pushed, AroundAGaitAHorizonOfTwoTenthsSurvivesFortyNewtons) {
  constexpr int kPhases = 6;
  RunRequest request = following(0.5, 0.2, 12.0);
  const double start_s = 4.2 + 0.3 * (GetParam() % 2 + static_cast<double>(GetParam()) / kPhases);
  request.pushes = {{40.0, start_s, 1.0, PushPoint::hip}};
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  EXPECT_TRUE(record.summary.survived) << "pushed at " << start_s << " s: " << describe(run, record);
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, Pushed, testing::Range(0, 6));

}  // namespace
}  // namespace stilt::simulation
