#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "firmware/realtime/allocation_counter.h"
#include "tests/closed_loop/simulated_run.h"

/// Each gait for a minute as a user gets it: shipped configuration, estimated state.
namespace stilt::simulation {
namespace {

using gait::GaitKind;
using testing_support::describe;
using testing_support::RunRequest;
using testing_support::SimulatedRun;
using testing_support::walking;

constexpr double kMinute_s = 60.0;

/// "1", "m0_3": a number as part of a test's name.
std::string name_of(double number) {
  const int tenths = static_cast<int>(std::lround(10.0 * std::abs(number)));
  char text[32];
  std::snprintf(text, sizeof text, "%s%d_%d", number < 0.0 ? "m" : "", tenths / 10, tenths % 10);
  return text;
}

std::string horizon_name(const ::testing::TestParamInfo<double>& test) {
  return "Horizon" + name_of(test.param);
}

/// On its feet at the end, every plan usable, nothing on the heap.
void expect_sound(const SimulatedRun& run, const log::RunRecord& record) {
  ASSERT_TRUE(record.summary.survived) << describe(run, record);
  for (const log::SolveSample& solve : record.solves) {
    ASSERT_TRUE(solve.report.usable()) << "plan at " << solve.time_s << " s";
  }
  if (realtime::counts_allocations()) {
    EXPECT_EQ(record.summary.heap_allocations_in_loop, 0);
  }
}

double steps(const log::RunRecord& record) { return static_cast<double>(record.summary.steps.size()); }

/// Of a run that steps from its start on.
double expected_steps(const SimulatedRun& run) {
  const gait::GaitParameters& gait = run.parameters.gait;
  return (run.settings.duration_s - gait.switch_lead_s) / (gait.single_support_s + gait.double_support_s);
}

class Gaits : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(ClosedLoop, Gaits, ::testing::Values(1.0, 2.0), horizon_name);

TEST_P(Gaits, StandsAMinuteWithoutAStep) {
  RunRequest request = walking(0.0, GetParam(), kMinute_s);
  request.commands = {{0.0, {GaitKind::stand, 0.0}}};
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  expect_sound(run, record);
  EXPECT_TRUE(record.summary.steps.empty());
  EXPECT_LT(std::abs(record.summary.distance_m), 0.05);
  EXPECT_LT(run.plant.state().tail<model::kPositions>().cwiseAbs().maxCoeff(), 0.01) << "still moving";
}

TEST_P(Gaits, StepsInPlaceAMinute) {
  RunRequest request = walking(0.0, GetParam(), kMinute_s);
  request.commands = {{0.0, {GaitKind::step, 0.0}}};
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  expect_sound(run, record);
  EXPECT_GE(steps(record), 0.97 * expected_steps(run)) << describe(run, record);
  EXPECT_LT(std::abs(record.summary.mean_speed_m_s), 0.01);
}

TEST_P(Gaits, GoesFromStandToStepToWalkToStand) {
  RunRequest request = walking(0.0, GetParam(), 24.0);
  request.commands = {{0.0, {GaitKind::stand, 0.0}},
                      {3.0, {GaitKind::step, 0.0}},
                      {7.0, {GaitKind::walk, 0.5}},
                      {17.0, {GaitKind::stand, 0.0}}};
  request.keep_samples = true;
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  expect_sound(run, record);
  const auto speed_between = [&](double from_s, double to_s) {
    double first_m = 0.0;
    double last_m = 0.0;
    for (const log::RunSample& sample : record.samples) {
      if (sample.time_s <= from_s) first_m = sample.true_state[0];
      if (sample.time_s <= to_s) last_m = sample.true_state[0];
    }
    return (last_m - first_m) / (to_s - from_s);
  };
  EXPECT_NEAR(speed_between(9.0, 17.0), 0.5, 0.05);
  EXPECT_NEAR(speed_between(21.0, 24.0), 0.0, 0.01);
  EXPECT_TRUE(record.samples.back().scheduled_mode.left && record.samples.back().scheduled_mode.right);
  EXPECT_GT(record.summary.steps.front().time_s, 3.0) << "it stood until the command to step";
  EXPECT_LT(record.summary.steps.back().time_s, 20.0) << "it came to a stand within 3 s";
}

struct Walk {
  double speed_m_s;
  double horizon_s;
};

class Walks : public ::testing::TestWithParam<Walk> {};

TEST_P(Walks, AMinuteAtTheCommandedSpeed) {
  SimulatedRun run(walking(GetParam().speed_m_s, GetParam().horizon_s, kMinute_s));
  const log::RunRecord record = run.run();
  expect_sound(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, GetParam().speed_m_s, 0.02);
  EXPECT_GE(steps(record), 0.97 * expected_steps(run)) << describe(run, record);
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, Walks,
                         ::testing::Values(Walk{-0.3, 1.0}, Walk{0.0, 1.0}, Walk{0.3, 1.0}, Walk{0.5, 1.0},
                                           Walk{0.8, 1.0}, Walk{-0.3, 2.0}, Walk{0.0, 2.0}, Walk{0.3, 2.0},
                                           Walk{0.5, 2.0}, Walk{0.8, 2.0}),
                         [](const auto& test) {
                           return "Speed" + name_of(test.param.speed_m_s) + "Horizon" +
                                  name_of(test.param.horizon_s);
                         });

class StandsAfterSteps : public ::testing::TestWithParam<double> {};

/// Two point feet at one place carry no robot: it would lean slowly until its legs are straight.
TEST_P(StandsAfterSteps, WithItsFeetApartWheneverTheStandIsCommanded) {
  RunRequest request = walking(0.0, 1.0, 10.0);
  request.commands = {{0.0, {GaitKind::step, 0.0}}, {GetParam(), {GaitKind::stand, 0.0}}};
  request.keep_samples = true;
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  expect_sound(run, record);
  const log::RunSample& end = record.samples.back();
  EXPECT_NEAR(std::abs(end.foot_position_m[0] - end.foot_position_m[2]),
              2.0 * run.parameters.gait.stand_half_width_m, 0.05);
  EXPECT_LT(std::abs(end.true_state[model::kFirstAngle]), 0.02);
  EXPECT_NEAR(end.true_state[1], run.parameters.reference.base_height_m, 0.01);
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, StandsAfterSteps,
                         ::testing::Values(3.0, 3.1, 3.2, 3.25, 3.279, 3.29, 3.3), [](const auto& test) {
                           return "At" + std::to_string(std::lround(1000.0 * test.param));
                         });

}  // namespace
}  // namespace stilt::simulation
