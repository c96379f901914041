#include "host_tools/simulator/closed_loop.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "host_tools/simulator/run_recorder.h"
#include "tests/host_tools/simulator/test_robots.h"

namespace stilt::simulator {
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
  const auto controller = std::make_unique<MpcController>();
  EXPECT_EQ(controller->configure(model::amber3m(), {}), control::ConfigureStatus::ok);
  return run_closed_loop(plant, *controller, walking_run(duration_s));
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
  EXPECT_EQ(record.solves.size(), 600u);
  EXPECT_EQ(record.plans.size(), 120u);
  EXPECT_GT(summary.peak_torque_Nm.minCoeff(), 10.0);
  EXPECT_GE(summary.sqp_iterations_max, 1);
}

TEST(ClosedLoop, TheTorqueLoopTicksEachMillisecondOfSimulatedTime) {
  Plant plant = amber_plant();
  HoldingController controller;
  const log::RunRecord record = run_closed_loop(plant, controller, standing_run(0.5));
  EXPECT_EQ(controller.ticks, 500);
  EXPECT_NEAR(controller.last_reading.time_s, 0.499, 1e-12);
  EXPECT_EQ(record.samples.size(), 100u);
  EXPECT_TRUE(record.solves.empty());
  EXPECT_TRUE(record.plans.empty());
}

TEST(ClosedLoop, ARunEndsWhenTheRobotFalls) {
  Plant plant = amber_plant();
  HoldingController controller;
  RunSettings settings = standing_run(5.0);
  settings.pushes = {{300.0, 0.5, 1.0, PushPoint::hip}};
  const log::RunSummary summary = run_closed_loop(plant, controller, settings).summary;
  EXPECT_FALSE(summary.survived);
  EXPECT_GT(summary.fall_time_s, 0.5);
  EXPECT_LT(summary.fall_time_s, 3.0);
  EXPECT_EQ(summary.duration_s, summary.fall_time_s);
}

TEST(ClosedLoop, TimeAtTheTorqueLimitIsCountedAndNoOther) {
  const auto saturated_s = [](double torque_limit_Nm) {
    PlantOptions options;
    options.torque_limit_Nm = torque_limit_Nm;
    Plant plant = amber_plant(options);
    HoldingController controller;
    return run_closed_loop(plant, controller, standing_run(0.2)).summary.saturated_s;
  };
  EXPECT_EQ(saturated_s(200.0), 0.0);
  // The holding controller asks for nothing before the joints have moved.
  EXPECT_GT(saturated_s(0.5), 0.18);
  EXPECT_LE(saturated_s(0.5), 0.2 + 1e-9);
}

TEST(ClosedLoop, PlansStartAtTheirRateAndWaitForTheOneBefore) {
  control::TimingParameters timing;
  timing.plan_rate_hz = 100.0;
  timing.plan_delay_s = 0.005;
  EXPECT_EQ(TickSchedule(timing).plan_period_ticks, 10);
  EXPECT_EQ(TickSchedule(timing).plan_delay_ticks, 5);
  timing.plan_delay_s = 0.025;
  EXPECT_EQ(TickSchedule(timing).plan_period_ticks, 25);
  timing.plan_delay_s = 0.0;
  EXPECT_EQ(TickSchedule(timing).plan_delay_ticks, 1);
}

/// Notes when each plan was made and when it came into use.
class PlanWatcher final : public Controller {
 public:
  void reset(const model::StateVector&, double) override {}
  TickOutput tick(const control::SensorReading& reading, const model::StateVector*) override {
    now_s_ = reading.time_s;
    if (adopted_) used_after_s.push_back(now_s_ - planned_at_s_);
    adopted_ = false;
    return {};
  }
  std::optional<solver::SolveReport> plan(double time_s, const gait::GaitCommand&) override {
    planned_at_s_ = time_s;
    return std::nullopt;
  }
  void adopt_plan() override { adopted_ = true; }
  [[nodiscard]] const control::Plan& newest_plan() const override { return plan_; }
  [[nodiscard]] const control::Plan& plan_in_use() const override { return plan_; }
  [[nodiscard]] std::size_t bytes() const override { return 0; }

  std::vector<double> used_after_s;

 private:
  control::Plan plan_;
  double now_s_ = 0.0;
  double planned_at_s_ = 0.0;
  bool adopted_ = false;
};

TEST(ClosedLoop, APlanComesIntoUseAfterThePlanningDelay) {
  Plant plant = amber_plant();
  const auto controller = std::make_unique<PlanWatcher>();
  RunSettings settings = standing_run(0.1);
  settings.timing.plan_delay_s = 0.007;
  (void)run_closed_loop(plant, *controller, settings);
  ASSERT_EQ(controller->used_after_s.size(), 10u);
  EXPECT_EQ(controller->used_after_s[0], 0.0);
  for (std::size_t i = 1; i < 10; ++i) EXPECT_NEAR(controller->used_after_s[i], 0.007, 1e-9);
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
}  // namespace stilt::simulator
