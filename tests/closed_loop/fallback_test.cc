#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/closed_loop/forwarding_controller.h"
#include "tests/closed_loop/simulated_run.h"

/// What the robot does when planning fails for a while: it goes on with the older plan.
namespace stilt::simulator {
namespace {

using testing_support::describe;
using testing_support::ForwardingController;
using testing_support::SimulatedRun;
using testing_support::walking;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPlanPeriod_s = 0.01;
constexpr double kTick_s = 0.001;

bool within(double time_s, double start_s, double duration_s) {
  return time_s > start_s - 0.5 * kTick_s && time_s < start_s + duration_s - 0.5 * kTick_s;
}

int failed_plans(const log::RunRecord& record) {
  int failed = 0;
  for (const log::SolveSample& solve : record.solves) failed += solve.report.usable() ? 0 : 1;
  return failed;
}

/// Gives the planner a command that is no number, for a while each second from 5 s on.
class MissingPlans final : public ForwardingController {
 public:
  MissingPlans(Controller& inner, int cycles) : ForwardingController(inner), cycles_(cycles) {}

  std::optional<solver::SolveReport> plan(double time_s, const gait::GaitCommand& command) override {
    const double in_second_s = time_s - std::floor(time_s + 0.5 * kTick_s);
    if (time_s < 5.0 || !within(in_second_s, 0.2, cycles_ * kPlanPeriod_s)) {
      return ForwardingController::plan(time_s, command);
    }
    const long long before = plan_in_use().sequence;
    const auto report = ForwardingController::plan(time_s, {command.kind, kNan});
    EXPECT_EQ(newest_plan().sequence, before) << "a failed plan must not be the newest";
    return report;
  }

 private:
  int cycles_;
};

/// Changes the sensors of single ticks, at which a plan starts, once a second from 5 s on.
class BadSensors final : public ForwardingController {
 public:
  BadSensors(Controller& inner, double joint_velocity_rad_s)
      : ForwardingController(inner), joint_velocity_rad_s_(joint_velocity_rad_s) {}

  TickOutput tick(const control::SensorReading& reading, const model::StateVector* truth) override {
    const double in_second_s = reading.time_s - std::floor(reading.time_s + 0.5 * kTick_s);
    if (reading.time_s < 5.0 || !within(in_second_s, 0.3, kTick_s)) {
      return ForwardingController::tick(reading, truth);
    }
    control::SensorReading bad = reading;
    bad.joint_velocity_rad_s[2] = joint_velocity_rad_s_;
    const TickOutput output = ForwardingController::tick(bad, truth);
    EXPECT_TRUE(output.torque_Nm.allFinite());
    return output;
  }

 private:
  double joint_velocity_rad_s_;
};

TEST(Fallback, APlanMissingNowAndThenIsReplacedByTheOlderOne) {
  SimulatedRun run(walking(0.5, 1.0, 15.0));
  MissingPlans controller(*run.controller, 1);
  const log::RunRecord record = run_closed_loop(run.plant, controller, run.settings);
  EXPECT_EQ(failed_plans(record), 10);
  EXPECT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, 0.5, 0.05);
}

TEST(Fallback, AHundredMillisecondsWithoutAPlanAreWalkedOnTheOlderOne) {
  SimulatedRun run(walking(0.5, 1.0, 15.0));
  MissingPlans controller(*run.controller, 10);
  const log::RunRecord record = run_closed_loop(run.plant, controller, run.settings);
  EXPECT_EQ(failed_plans(record), 100);
  EXPECT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, 0.5, 0.05);
}

TEST(Fallback, AStateThatIsNoNumberCostsOnePlan) {
  SimulatedRun run(walking(0.5, 1.0, 15.0));
  BadSensors controller(*run.controller, kNan);
  const log::RunRecord record = run_closed_loop(run.plant, controller, run.settings);
  EXPECT_EQ(failed_plans(record), 10);
  EXPECT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, 0.5, 0.05);
}

TEST(Fallback, ASolveThatOverflowsCostsOnePlan) {
  SimulatedRun run(walking(0.5, 1.0, 15.0));
  BadSensors controller(*run.controller, 1e200);
  const log::RunRecord record = run_closed_loop(run.plant, controller, run.settings);
  EXPECT_EQ(failed_plans(record), 10);
  EXPECT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, 0.5, 0.05);
}

}  // namespace
}  // namespace stilt::simulator
