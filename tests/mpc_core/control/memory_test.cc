#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdio>
#include <memory>

#include "firmware/configuration/configuration.h"
#include "firmware/realtime/allocation_counter.h"
#include "mpc_core/control/planner.h"
#include "mpc_core/control/torque_law.h"
#include "tests/closed_loop/simulated_run.h"
#include "tests/robots.h"

/// The controller's memory: fixed, small, touched once.
namespace stilt::control {
namespace {

using realtime::AllocationScope;
using realtime::counts_allocations;

constexpr std::size_t kMebibyte = 1024 * 1024;

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

TEST(Memory, OfPlannerPlanAndTorqueLawIsSmall) {
  std::printf("planner %zu, plan %zu, torque law %zu bytes\n", sizeof(Planner), sizeof(Plan),
              sizeof(TorqueLaw));
  EXPECT_LE(sizeof(Planner), 2 * kMebibyte);
  EXPECT_LE(sizeof(Plan), kMebibyte / 2);
  EXPECT_LE(sizeof(TorqueLaw), 4096U);
}

TEST(Memory, AWholeWalkAllocatesNothing) {
  if (!counts_allocations()) GTEST_SKIP() << "this build's allocator cannot be counted";
  testing_support::RunRequest request = testing_support::walking(0.5, 2.0, 20.0);
  request.commands = {{0.0, {gait::GaitKind::stand, 0.0}},
                      {1.0, {gait::GaitKind::step, 0.0}},
                      {4.0, {gait::GaitKind::walk, 0.5}},
                      {15.0, {gait::GaitKind::stand, 0.0}}};
  request.pushes = {{30.0, 8.0, 1.0, simulation::PushPoint::hip}};
  testing_support::SimulatedRun run(request);
  const log::RunRecord record = run.run();
  EXPECT_TRUE(record.summary.survived);
  EXPECT_EQ(record.summary.heap_allocations_in_loop, 0);
}

TEST(Memory, EveryEndOfASolveAllocatesNothing) {
  if (!counts_allocations()) GTEST_SKIP() << "this build's allocator cannot be counted";
  const model::RobotModel& robot = testing_support::amber3m();
  ControllerParameters parameters = configuration::load_robot("amber3m").value();
  const auto planner = std::make_unique<Planner>();
  const auto plan = std::make_unique<Plan>();
  const model::StateVector standing = gait::standing_state(robot.constants, 0.8, 0.0, 0.15, true);
  model::StateVector huge = standing;
  huge.tail<model::kJoints>().setConstant(1e200);
  const AllocationScope scope;
  for (const int iterations : {1, 10}) {
    parameters.sqp.iterations = iterations;
    ASSERT_EQ(planner->configure(robot, parameters), ConfigureStatus::ok);
    planner->reset(0.0);
    (void)planner->plan({0.0, standing, {}}, *plan);
    (void)planner->plan({0.01, huge, {}}, *plan);
    (void)planner->plan({0.02, standing, {}}, *plan);
  }
  EXPECT_EQ(scope.count(), 0);
}

/// The operating system may take pages back at any time, so that one quiet stretch out of several proves it.
TEST(Memory, APlannerInUseTouchesNoNewPage) {
  const auto run = [](Planner& planner, const TorqueLaw& law, Plan& plan, double& time_s) {
    const model::RobotModel& robot = testing_support::amber3m();
    const model::StateVector standing = gait::standing_state(robot.constants, 0.8, 0.0, 0.15, true);
    SensorReading reading;
    reading.joint_position_rad = standing.segment<model::kJoints>(model::kFirstJoint);
    const long before = page_faults();
    for (int cycle = 0; cycle < 50; ++cycle, time_s += 0.01) {
      (void)planner.plan({time_s, standing, {gait::GaitKind::step, 0.0}}, plan);
      reading.time_s = time_s;
      (void)law.follow(reading, standing, interpolate(plan, time_s));
    }
    return page_faults() - before;
  };
  const ControllerParameters parameters = configuration::load_robot("amber3m").value();
  const auto planner = std::make_unique<Planner>();
  const auto plan = std::make_unique<Plan>();
  TorqueLaw law;
  ASSERT_EQ(planner->configure(testing_support::amber3m(), parameters), ConfigureStatus::ok);
  law.configure(testing_support::amber3m(), parameters);
  planner->reset(0.0);
  double time_s = 0.0;
  (void)run(*planner, law, *plan, time_s);
  long faults = 1;
  for (int attempt = 0; attempt < 10 && faults > 0; ++attempt) faults = run(*planner, law, *plan, time_s);
  EXPECT_EQ(faults, 0);
}

}  // namespace
}  // namespace stilt::control
