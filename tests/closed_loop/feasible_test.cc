#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "tests/closed_loop/simulated_run.h"

/// The preset `feasible`: large pushes are survived by plans that ground and drives can execute
/// (docs/decisions/0022-feasible-plans.md). Forces are 85 % of those survived at every phase of the search.
namespace stilt::simulation {
namespace {

using testing_support::describe;
using testing_support::SimulatedRun;

/// Force, N, where it acts, and start, s.
class FeasiblePlans : public ::testing::TestWithParam<std::tuple<std::tuple<double, PushPoint>, double>> {};

TEST_P(FeasiblePlans, SurvivePushesWithoutForcesOutsideTheConeAndWithoutDefects) {
  const auto [push, start_s] = GetParam();
  const auto [force_N, point] = push;
  SimulatedRun run({.preset = "feasible",
                    .plant = {"encoder_noise_rad=0.0005", "encoder_velocity_noise_rad_s=0.02",
                              "base_angle_noise_rad=0.001", "base_rate_noise_rad_s=0.01"},
                    .commands = {{0.0, {gait::GaitKind::walk, 0.5}}},
                    .pushes = {{force_N, start_s, 1.0, point}},
                    .duration_s = start_s + 4.0});
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << describe(run, record);
  const log::PlanInUse& plan = record.summary.plan_in_use;
  EXPECT_LE(plan.cone_violation_max_N, 5.0);
  EXPECT_GE(plan.normal_force_min_N, 0.0);
  EXPECT_LE(plan.defect_max, 0.05);
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, FeasiblePlans,
                         ::testing::Combine(::testing::Values(std::tuple{123.0, PushPoint::hip},
                                                              std::tuple{-119.0, PushPoint::hip},
                                                              std::tuple{64.0, PushPoint::torso},
                                                              std::tuple{-72.0, PushPoint::torso}),
                                            ::testing::Values(3.05, 3.1, 3.25, 3.3)));

}  // namespace
}  // namespace stilt::simulation
