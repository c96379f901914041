#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <random>

#include "host_tools/benchmark/plan_sample.h"
#include "host_tools/benchmark/planner_kernels.h"
#include "host_tools/cli/planning_problems.h"

/// The time of a plan is predictable: with a fixed number of iterations the longest plans take little more
/// than the typical one. A solve that may end early never takes longer than that. Counted in instructions,
/// which depend neither on the clock nor on other programs.
namespace stilt::cli {
namespace {

using benchmark::PlanSample;

constexpr int kPlansPerWalk = 500;
constexpr double kLargestRatio = 1.3;
/// Of the median plan with AVX2: 5.126 of GCC 12, and 10 % more.
constexpr double kMedianMinstructions = 5.64;
/// Of plans that may end early, with AVX2: 1.04 at the median, the longest 2.18, divided by 0.85.
constexpr double kEarlyMedianMinstructions = 1.22, kEarlyMostMinstructions = 2.56;

/// Every plan of a walk.
std::vector<PlanSample> measured(const ControllerChoice& choice, const Walk& request,
                                 benchmark::WorkTable& table) {
  const auto controller =
      make_controller(controller_setup(choice, robot_model(choice.robot), controller_configuration(choice)));
  std::vector<PlanSample> samples;
  const PlanObserver observer{[] {},
                              [&](const control::PlannerInput& input) {
                                PlanSample sample;
                                sample.time_s = input.time_s;
                                benchmark::describe_work(*benchmark::planner_of_build(controller->planner()),
                                                         controller->report(), table, sample);
                                samples.push_back(sample);
                              }};
  EXPECT_TRUE(walk(choice, request, *controller, observer)) << "the robot fell";
  return samples;
}

/// Plans of walks that begin anew, are pushed and stumble over a step.
std::vector<PlanSample> measured_campaign(const ControllerChoice& choice, int walks) {
  constexpr std::uint64_t kSeed = 5;
  std::mt19937_64 random(kSeed);
  const auto drawn = [&](double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random() >> 11), -53);
  };
  const auto table = std::make_unique<benchmark::WorkTable>();
  std::vector<PlanSample> all;
  for (int i = 0; i < walks; ++i) {
    Walk request{.plans = kPlansPerWalk};
    request.pushes = {
        {(i % 2 == 0 ? 1.0 : -1.0) * drawn(20.0, 100.0), drawn(2.0, 2.6), 1.0, simulation::PushPoint::hip}};
    request.world.step_height_m = drawn(-0.02, 0.02);
    request.world.step_position_m = drawn(0.3, 1.0);
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", walk " << i);
    const std::vector<PlanSample> samples = measured(choice, request, *table);
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return all;
}

benchmark::Tail instructions_of(const std::vector<PlanSample>& samples) {
  std::vector<double> instructions;
  for (const PlanSample& sample : samples) instructions.push_back(static_cast<double>(sample.instructions));
  const benchmark::Tail tail = benchmark::tail(std::move(instructions));
  std::printf("Minstructions of a plan: p50 %.3f, p99.9 %.3f, max %.3f\n", 1e-6 * tail.p50, 1e-6 * tail.p999,
              1e-6 * tail.max);
  for (const PlanSample& s : benchmark::worst(samples, 3)) {
    std::printf(
        "  %.2f s: %d iterations, %d trial steps, %d stages, of them %d touch-downs, %d of double support\n",
        s.time_s, s.iterations, s.trial_steps, s.stages, s.transitions, s.double_support_stages);
  }
  return tail;
}

TEST(SolveTime, TheLongestPlanOfWalksThatArePushedAndStumbleTakesLittleMoreThanTheMedian) {
  if (!benchmark::can_count_work()) GTEST_SKIP() << "this processor or build cannot be stepped through";
  ControllerChoice all_iterations;
  all_iterations.no_early_stop = true;
  all_iterations.iterations = 10;
  const std::vector<PlanSample> samples = measured_campaign(all_iterations, 20);
  ASSERT_GE(samples.size(), 10'000u);
  const benchmark::Tail tail = instructions_of(samples);
  EXPECT_GT(tail.p50, 0.0);
  EXPECT_LE(tail.max, kLargestRatio * tail.p50);
  const benchmark::Tail early = instructions_of(measured_campaign({}, 4));
  EXPECT_LE(early.max, kLargestRatio * tail.p50) << "a solve that may end early";
#ifdef EIGEN_NO_DEBUG  // optimised
  if (dispatch::instruction_set_of_build() != model::InstructionSet::avx2) return;
  EXPECT_LE(1e-6 * tail.p50, kMedianMinstructions);
  EXPECT_LE(1e-6 * early.p50, kEarlyMedianMinstructions);
  EXPECT_LE(1e-6 * early.max, kEarlyMostMinstructions);
#endif
}

}  // namespace
}  // namespace stilt::cli
