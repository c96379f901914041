#include "host_tools/simulation/closed_loop/closed_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "host_tools/simulation/closed_loop/run_recorder.h"
#include "tests/firmware/supervisor/printers.h"
#include "tests/host_tools/simulation/plant/test_robots.h"
#include "tests/robots.h"

namespace stilt::simulation {
namespace {

RunSettings standing_run(double duration_s) {
  RunSettings settings;
  settings.duration_s = duration_s;
  settings.leg = kAmberLeg;
  settings.initial_state = standing_state(kAmberLeg, kHipHeight_m, 0.15);
  return settings;
}

RunSettings walking_run(double duration_s) {
  RunSettings settings = standing_run(duration_s);
  settings.commands = {{0.0, {gait::GaitKind::walk, 0.5}}};
  return settings;
}

/// A walk with noisy sensors.
log::RunRecord noisy_walk(std::uint64_t seed, double duration_s) {
  PlantOptions options;
  options.encoder_noise_rad = 1e-3;
  options.encoder_velocity_noise_rad_s = 0.05;
  Plant plant = amber_plant(options, seed);
  return run_closed_loop(plant, *amber_controller(), walking_run(duration_s));
}

TEST(ClosedLoop, TwoRunsOfTheSameSeedAreIdenticalAndAnotherSeedDiffers) {
  const log::RunRecord first = noisy_walk(5, 2.0), second = noisy_walk(5, 2.0), other = noisy_walk(6, 2.0);
  ASSERT_EQ(first.samples.size(), second.samples.size());
  ASSERT_EQ(first.samples.size(), 400u);
  for (std::size_t i = 0; i < first.samples.size(); ++i) {
    const log::RunSample &a = first.samples[i], &b = second.samples[i];
    ASSERT_EQ(a.true_state, b.true_state);
    ASSERT_EQ(a.estimated_state, b.estimated_state);
    ASSERT_EQ(a.planned_state, b.planned_state);
    ASSERT_EQ(a.torque_Nm, b.torque_Nm);
    ASSERT_EQ(a.contact_force_N, b.contact_force_N);
  }
  for (std::size_t i = 0; i < first.solves.size(); ++i) {
    ASSERT_EQ(first.solves[i].report.cost, second.solves[i].report.cost);
  }
  EXPECT_NE(first.samples.back().true_state, other.samples.back().true_state);
}

TEST(ClosedLoop, AnAutomaticInstructionSetIsThatOfTheBuild) {
  const auto controller = amber_controller();
  EXPECT_EQ(controller->planner().instruction_set(), dispatch::instruction_set_of_build());
}

TEST(ClosedLoop, TheControllersCallsNeverTouchTheHeap) {
  EXPECT_EQ(noisy_walk(1, 3.0).summary.heap_allocations_in_loop, 0);
}

TEST(ClosedLoop, AWalkIsSummedUpAsItHappened) {
  const log::RunRecord record = noisy_walk(1, 6.0);
  const log::RunSummary& summary = record.summary;
  EXPECT_TRUE(summary.survived);
  EXPECT_LT(summary.fall_time_s, 0.0);
  EXPECT_EQ(summary.duration_s, 6.0);
  EXPECT_NEAR(summary.distance_m, record.samples.back().true_state[0], 0.01);
  EXPECT_NEAR(summary.mean_speed_m_s, 0.5, 0.05);
  EXPECT_GT(summary.steps.size(), 10u);
  for (std::size_t i = 1; i < summary.steps.size(); ++i) {
    EXPECT_NE(summary.steps[i].foot, summary.steps[i - 1].foot) << "step " << i;
  }
  EXPECT_EQ(record.solves.size(), 3000u);
  EXPECT_EQ(record.plans.size(), 120u);
  EXPECT_GT(summary.peak_torque_Nm.minCoeff(), 10.0);
  EXPECT_GE(summary.sqp_iterations_max, 1);
}

TEST(ClosedLoop, TheControlLoopTicksEachMillisecondOfSimulatedTime) {
  Plant plant = amber_plant();
  RunSettings settings = standing_run(0.5);
  int ticks = 0;
  std::int64_t last_ns = 0;
  settings.observer.ticked = [&](const control_loop::TickRecord& tick) {
    EXPECT_EQ(tick.tick, static_cast<std::uint64_t>(ticks++));
    EXPECT_EQ(tick.time_ns - last_ns, 1'000'000);
    last_ns = tick.time_ns;
  };
  const log::RunRecord record = run_closed_loop(plant, *amber_controller(), settings);
  EXPECT_EQ(ticks, 500);
  EXPECT_EQ(record.samples.size(), 100u);
  EXPECT_EQ(record.solves.size(), 250u);
  EXPECT_EQ(record.plans.size(), 10u);
}

TEST(ClosedLoop, ARunEndsWhenTheRobotFalls) {
  Plant plant = amber_plant();
  RunSettings settings = standing_run(5.0);
  settings.pushes = {{300.0, 0.5, 1.0, PushPoint::hip}};
  const log::RunSummary summary = run_closed_loop(plant, *amber_controller(), settings).summary;
  EXPECT_FALSE(summary.survived);
  EXPECT_GT(summary.fall_time_s, 0.5);
  EXPECT_LT(summary.fall_time_s, 3.0);
  EXPECT_EQ(summary.duration_s, summary.fall_time_s);
}

TEST(ClosedLoop, TheSmallestMarginToAFallIsThatOfTheWorstMoment) {
  const auto margin = [](double force_N, double duration_s = 2.0) {
    Plant plant = amber_plant();
    RunSettings settings = standing_run(duration_s);
    if (force_N > 0.0) settings.pushes = {{force_N, 0.5, 0.3, PushPoint::hip}};
    return run_closed_loop(plant, *amber_controller(), settings).summary.fall_margin_min;
  };
  EXPECT_GT(margin(0.0), 0.9);
  EXPECT_LT(margin(40.0), margin(0.0));
  EXPECT_GT(margin(40.0), 0.0);
  EXPECT_LE(margin(40.0), margin(40.0, 0.85)) << "the smallest of a run is at most that of its beginning";
  EXPECT_LT(margin(400.0), 0.1) << "a fall";
}

TEST(ClosedLoop, TimeAtTheTorqueLimitIsCountedAndNoOther) {
  const auto saturated_s = [](double torque_limit_Nm) {
    PlantOptions options;
    options.torque_limit_Nm = torque_limit_Nm;
    Plant plant = amber_plant(options);
    return run_closed_loop(plant, *amber_controller(), standing_run(0.2)).summary.saturated_s;
  };
  EXPECT_EQ(saturated_s(200.0), 0.0);
  EXPECT_GT(saturated_s(0.5), 0.18);
  EXPECT_LE(saturated_s(0.5), 0.2 + 1e-9);
}

TEST(ClosedLoop, PlansStartAtTheirRateAndWaitForTheOneBefore) {
  using control_loop::PlanTiming;
  control::TimingParameters timing;
  timing.plan_rate_hz = 100.0;
  timing.plan_delay_s = 0.005;
  EXPECT_EQ(PlanTiming(timing).period_ticks, 10);
  EXPECT_EQ(PlanTiming(timing).delay_ticks, 5);
  timing.plan_delay_s = 0.025;
  EXPECT_EQ(PlanTiming(timing).period_ticks, 25);
  timing.plan_delay_s = 0.0;
  EXPECT_EQ(PlanTiming(timing).delay_ticks, 1);
}

TEST(ClosedLoop, APlanIsActiveAfterThePlanningDelayTheFirstAtOnce) {
  Plant plant = amber_plant();
  ControllerSetup setup;
  setup.parameters.timing.plan_rate_hz = 100.0;
  setup.parameters.timing.plan_delay_s = 0.007;
  RunSettings settings = standing_run(0.1);
  std::vector<double> first_age_s;
  long long sequence = -1;
  settings.observer.ticked = [&](const control_loop::TickRecord& tick) {
    EXPECT_GE(tick.plan_sequence, 0);
    if (tick.plan_sequence != sequence) first_age_s.push_back(tick.plan_age_s);
    sequence = tick.plan_sequence;
  };
  (void)run_closed_loop(plant, *amber_controller(setup), settings);
  ASSERT_EQ(first_age_s.size(), 10u);
  EXPECT_EQ(first_age_s[0], 0.0);
  for (std::size_t i = 1; i < 10; ++i) EXPECT_NEAR(first_age_s[i], 0.007, 1e-9);
}

TEST(ClosedLoop, PlansInUseAreJudgedByTheFrictionTheyAssume) {
  const auto violation_N = [](double assumed) {
    ControllerSetup setup;
    setup.parameters.inequality.friction_coefficient = assumed;
    setup.parameters.sqp.plan_cone_violation_max_N = 1e6;  // such plans are used
    setup.parameters.sqp.plan_pulling_force_max_N = 1e6;
    Plant plant = amber_plant({});
    return run_closed_loop(plant, *amber_controller(setup), walking_run(2.0))
        .summary.plan_in_use.cone_violation_max_N;
  };
  EXPECT_EQ(violation_N(0.6), 0.0) << "as the ground has";
  EXPECT_GT(violation_N(0.05), 10.0) << "less than walking takes";
}

TEST(ClosedLoop, AKnownStateReplacesAllOfTheEstimateButTheVelocityOfTheBase) {
  for (const bool known : {false, true}) {
    PlantOptions options;
    options.base_pitch_noise_rad = 0.01;
    Plant plant = amber_plant(options);
    RunSettings settings = standing_run(0.2);
    settings.use_true_state = known;
    double largest_error = 0.0;
    const log::RunRecord record = run_closed_loop(plant, *amber_controller(), settings);
    for (const log::RunSample& sample : record.samples) {
      model::StateVector error = sample.estimated_state - sample.true_state;
      error.segment<2>(model::kPositions).setZero();
      largest_error = std::max(largest_error, error.cwiseAbs().maxCoeff());
    }
    EXPECT_EQ(largest_error == 0.0, known) << largest_error;
  }
}

TEST(ClosedLoop, WithoutItsPlannerTheRobotFallsBackLevelByLevel) {
  Plant plant = amber_plant();
  RunSettings settings = walking_run(3.0);
  settings.planner_until_s = 2.0;
  const log::RunSummary summary = run_closed_loop(plant, *amber_controller(), settings).summary;
  const auto at = [&](supervisor::FallbackLevel level) {
    return summary.fallback_s[static_cast<std::size_t>(level)];
  };
  EXPECT_NEAR(at(supervisor::FallbackLevel::plan), 2.098, 0.0015) << "the last plan is of 1.998 s";
  EXPECT_NEAR(at(supervisor::FallbackLevel::plan_feedback), 0.15, 0.0015);
  EXPECT_EQ(at(supervisor::FallbackLevel::gait), 0.0) << "it has none";
  EXPECT_GT(at(supervisor::FallbackLevel::sit), 0.1);
}

TEST(ClosedLoop, TheTimeStepOfThePhysicsDividesTheTick) {
  EXPECT_EQ(time_step_for_tick(0.0005, 0.001), 0.0005);
  EXPECT_NEAR(time_step_for_tick(0.0004, 0.001), 0.001 / 3.0, 1e-15);
}

TEST(Percentiles, AreNearestRanks) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  EXPECT_EQ(percentile(values, 0.5), 50.0);
  EXPECT_EQ(percentile(values, 0.99), 99.0);
  EXPECT_EQ(percentile(values, 1.0), 100.0);
  EXPECT_EQ(percentile({}, 0.5), 0.0);
  EXPECT_EQ(percentile({7.0}, 0.01), 7.0);
}

}  // namespace
}  // namespace stilt::simulation
