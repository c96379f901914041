#include "host_tools/experiments/paired.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace stilt::experiments {
namespace {

WalkRunner survives_up_to(double phase_s) {
  return [=](const WalkCase& walk) {
    log::RunRecord record;
    record.summary.survived = std::fmod(walk.push_start_s - 0.3, 0.6) <= phase_s;
    return record;
  };
}

/// Two variants; the second falls at the later phases of the step.
PairedPlan plan_of(int cases, double second_survives_to_s) {
  PairedPlan plan;
  plan.cases = cases;
  plan.variants = {{"usual", {{"rate", 100}}}, {"other", {{"rate", 200}}}};
  plan.pushes = {{"weak", 20.0, "hip", {survives_up_to(1.0), survives_up_to(1.0)}},
                 {"strong", 90.0, "torso", {survives_up_to(1.0), survives_up_to(second_survives_to_s)}}};
  plan.comparisons = {{0, 1}};
  return plan;
}

std::vector<Json> results_of(const PairedPlan& plan) {
  std::vector<Json> results;
  for (const Job& job : paired_jobs(plan)) results.push_back(job.run());
  return results;
}

// Bonett and Price 2012, "Adjusted Wald confidence interval for a difference of binomial proportions based on
// paired data". By hand, for 100 pairs with 15 of one kind and 5 of the other:
//
//   (16 - 6) / 102 +- 1.96 sqrt((16 + 6) / 102 - (10 / 102)^2) / sqrt(102)
TEST(Paired, IntervalOfTheChangeIsThatOfBonettAndPrice) {
  const Estimate change = change_of_share({.cases = 100, .lost = 5, .gained = 15});
  EXPECT_DOUBLE_EQ(change.value, 0.10);
  EXPECT_NEAR(change.interval.low, 0.09804 - 0.08810, 5e-4);
  EXPECT_NEAR(change.interval.high, 0.09804 + 0.08810, 5e-4);
}

TEST(Paired, WithoutADifferenceTheIntervalContainsZero) {
  const Estimate change = change_of_share({.cases = 192, .lost = 0, .gained = 0});
  EXPECT_EQ(change.value, 0.0);
  EXPECT_LT(change.interval.low, 0.0);
  EXPECT_GT(change.interval.high, 0.0);
}

TEST(Paired, PhasesLieWithinTwoStepsAndEachCaseHasItsOwnNoise) {
  const PairedPlan plan = plan_of(64, 1.0);
  std::set<std::uint64_t> seeds;
  double earliest_s = 1e9, latest_s = 0.0;
  for (int number = 0; number < plan.cases; ++number) {
    const WalkCase walk = paired_walk(plan, plan.pushes[0], number);
    PairedPush weaker = plan.pushes[0];
    weaker.force_N *= 0.85;
    EXPECT_EQ(walk.push_start_s, paired_walk(plan, weaker, number).push_start_s) << number;
    EXPECT_NE(walk.push_start_s, paired_walk(plan, plan.pushes[1], number).push_start_s) << number;
    seeds.insert(walk.seed);
    seeds.insert(paired_walk(plan, plan.pushes[1], number).seed);
    earliest_s = std::min(earliest_s, walk.push_start_s);
    latest_s = std::max(latest_s, walk.push_start_s);
  }
  EXPECT_EQ(seeds.size(), 128u) << "cases of different pushes are independent";
  EXPECT_GE(earliest_s, plan.settled_s);
  EXPECT_LT(latest_s, plan.settled_s + 3.0 * plan.step_time_s);
  EXPECT_GT(latest_s - earliest_s, plan.step_time_s);
}

TEST(Paired, AVariantThatFallsMoreOftenIsWorse) {
  const PairedPlan plan = plan_of(64, 0.3);
  const Json merged = merge_paired(plan, results_of(plan));
  EXPECT_EQ(merged.at("rows")[0].at("survived").at("other"), 64);
  const int survived = merged.at("rows")[1].at("survived").at("other").get<int>();
  EXPECT_GT(survived, 16);
  EXPECT_LT(survived, 48);
  const Json& comparison = merged.at("comparisons")[0];
  EXPECT_EQ(comparison.at("cases"), 128);
  EXPECT_EQ(comparison.at("lost"), 64 - survived);
  EXPECT_EQ(comparison.at("gained"), 0);
  EXPECT_TRUE(comparison.at("worse").get<bool>());
  EXPECT_NE(paired_table(merged).find("| strong | 64 of 64 | " + std::to_string(survived) + " of 64 |"),
            std::string::npos)
      << paired_table(merged);
}

TEST(Paired, ASingleLostCaseIsNoEvidence) {
  PairedPlan plan = plan_of(64, 1.0);
  std::vector<Json> results = results_of(plan);
  results[0]["survived"]["other"] = false;
  const Json merged = merge_paired(plan, results);
  EXPECT_EQ(merged.at("comparisons")[0].at("lost"), 1);
  EXPECT_FALSE(merged.at("comparisons")[0].at("worse").get<bool>());
}

}  // namespace
}  // namespace stilt::experiments
