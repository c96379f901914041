#include <gtest/gtest.h>

#include <cstdio>
#include <memory>

#include "host_tools/benchmark/plan_sample.h"
#include "host_tools/cli/planning_problems.h"

/// The time of a plan is predictable: with a fixed number of iterations the longest plans take little more
/// than the typical one. Counted in instructions, which depend neither on the clock nor on other programs.
namespace stilt::cli {
namespace {

constexpr int kPlans = 10000;
constexpr double kLargestRatio = 1.3;

std::vector<benchmark::PlanSample> measured_walk(int plans) {
  ControllerChoice choice;
  choice.no_early_stop = true;
  choice.iterations = 10;
  const auto controller =
      make_controller(controller_setup(choice, robot_model(choice.robot), controller_configuration(choice)));
  const auto table = std::make_unique<benchmark::WorkTable>();
  std::vector<benchmark::PlanSample> samples;
  const PlanObserver observer{[] {},
                              [&](const control::PlannerInput& input) {
                                benchmark::PlanSample sample;
                                sample.time_s = input.time_s;
                                benchmark::describe_work(controller->planner(), controller->report(), *table,
                                                         sample);
                                samples.push_back(sample);
                              }};
  EXPECT_TRUE(walk(choice, 0.5, plans, *controller, observer)) << "the robot fell";
  return samples;
}

TEST(SolveTime, TheLongestOfTenThousandPlansTakesLittleMoreThanTheMedian) {
  if (!benchmark::can_count_work()) GTEST_SKIP() << "this processor or build cannot be stepped through";
  const std::vector<benchmark::PlanSample> samples = measured_walk(kPlans);
  ASSERT_GE(samples.size(), static_cast<std::size_t>(kPlans));
  std::vector<double> instructions;
  for (const benchmark::PlanSample& sample : samples) {
    EXPECT_EQ(sample.iterations, 10);
    instructions.push_back(static_cast<double>(sample.instructions));
  }
  const benchmark::Tail tail = benchmark::tail(std::move(instructions));
  std::printf("Minstructions of a plan: p50 %.3f, p99.9 %.3f, max %.3f\n", 1e-6 * tail.p50, 1e-6 * tail.p999,
              1e-6 * tail.max);
  for (const benchmark::PlanSample& s : benchmark::worst(samples, 3)) {
    std::printf("  %.2f s: %d trial steps, %d stages, of them %d touch-downs, %d of double support\n",
                s.time_s, s.trial_steps, s.stages, s.transitions, s.double_support_stages);
  }
  EXPECT_GT(tail.p50, 0.0);
  EXPECT_LE(tail.ratio(), kLargestRatio);
}

}  // namespace
}  // namespace stilt::cli
