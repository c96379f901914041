#include "host_tools/benchmark/plan_sample.h"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>

#include "tests/robots.h"

namespace stilt::benchmark {
namespace {

TEST(PlanSample, PercentilesAreNearestRanks) {
  std::vector<double> values(1000);
  std::iota(values.rbegin(), values.rend(), 1.0);
  const Tail t = tail(values);
  EXPECT_EQ(t.p50, 500.0);
  EXPECT_EQ(t.p99, 990.0);
  EXPECT_EQ(t.p999, 999.0);
  EXPECT_EQ(t.max, 1000.0);
  EXPECT_DOUBLE_EQ(t.ratio(), 999.0 / 500.0);
  EXPECT_EQ(tail({7.0}).p999, 7.0);
  EXPECT_EQ(tail({}).ratio(), 0.0);
}

TEST(PlanSample, TheWorstHaveTheMostInstructions) {
  std::vector<PlanSample> samples(4);
  for (int i = 0; i < 4; ++i) samples[static_cast<std::size_t>(i)].time_s = i;
  samples[1].instructions = samples[3].instructions = 9;
  samples[2].instructions = 5;
  const std::vector<PlanSample> found = worst(samples, 3);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].time_s, 1.0);
  EXPECT_EQ(found[1].time_s, 3.0);
  EXPECT_EQ(found[2].time_s, 2.0);
  EXPECT_EQ(worst(samples, 9).size(), 4U);
}

TEST(PlanSample, DescribesWhatAPlanConsistedOf) {
  control::ControllerParameters parameters;
  parameters.discretisation.horizon_s = 0.6;
  parameters.sqp.iterations = 4;
  parameters.sqp.early_stop = false;
  const auto planner = std::make_unique<control::Planner>();
  const auto plan = std::make_unique<control::Plan>();
  const auto table = std::make_unique<WorkTable>();
  ASSERT_EQ(planner->configure(testing_support::amber3m(), parameters), control::ConfigureStatus::ok);
  planner->reset(0.0);
  const sqp::SolveReport report = planner->plan(
      {0.0, gait::standing_state(testing_support::amber3m().constants, 0.8, 0.0, 0.15, true), {}}, *plan);
  ASSERT_TRUE(report.usable());
  PlanSample sample;
  describe_work(*planner, report, *table, sample);
  EXPECT_EQ(sample.iterations, 4);
  EXPECT_GE(sample.trial_steps, 4);
  EXPECT_EQ(sample.stages, 40);
  EXPECT_EQ(sample.transitions, 0);
  EXPECT_EQ(sample.double_support_stages, 40) << "it stands";
  if (!can_count_work()) GTEST_SKIP() << "this processor or build cannot be stepped through";
  const IterationWork work = table->work_of(*planner);
  EXPECT_EQ(sample.instructions, 4 * (work.linearise.instructions + work.sweep.instructions) +
                                     (sample.trial_steps + 1) * work.evaluate.instructions);
}

}  // namespace
}  // namespace stilt::benchmark
