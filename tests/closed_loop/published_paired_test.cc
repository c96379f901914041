#include <gtest/gtest.h>

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "host_tools/cli/paired_experiment.h"
#include "tests/closed_loop/published_plan.h"
#include "tests/closed_loop/published_results.h"

/// The paired pushes of docs/results/paired.json. A variant that survived half of the cases of a push
/// survives three of these cases at 85 % of the force.
namespace stilt::experiments {
namespace {

using testing_support::kGuardedShare;
using testing_support::results_of;

/// Numbers of a push and of a variant in the plan.
struct Survived {
  std::size_t push, variant;
  std::string name;

  friend std::ostream& operator<<(std::ostream& stream, const Survived& one) { return stream << one.name; }
};

PairedPlan plan() { return cli::paired_plan(testing_support::published_options("paired")); }

std::vector<Survived> survived_in_half_the_cases() {
  const PairedPlan paired = plan();
  const Json results = results_of("paired");
  std::vector<Survived> all;
  for (std::size_t p = 0; p < paired.pushes.size() && p < results.at("rows").size(); ++p) {
    for (std::size_t v = 0; v < paired.variants.size(); ++v) {
      const Json count = results.at("rows")[p].at("survived").value(paired.variants[v].name, Json());
      if (!count.is_number() || 2 * count.get<int>() < results.at("cases").get<int>()) continue;
      all.push_back(
          {p, v, testing_support::test_name(paired.pushes[p].name + "_" + paired.variants[v].name)});
    }
  }
  return all;
}

TEST(PublishedTables, HaveResultsOfThePairedPushes) {
  EXPECT_EQ(results_of("paired").at("rows").size(), plan().pushes.size());
  EXPECT_EQ(survived_in_half_the_cases().size(), 12u);
}

/// What is guarded is what was measured.
TEST(PublishedTables, HaveTheConditionsOfThePairedPushes) {
  PairedPlan today = cli::paired_plan(testing_support::published_options("paired"));
  for (PairedPush& push : today.pushes) {
    for (WalkRunner& walk : push.walk) walk = testing_support::no_walk;
  }
  const Json merged = merge_paired(today, testing_support::results_without_walks(paired_jobs(today)));
  const Json published = results_of("paired");
  testing_support::expect_published(merged, published,
                                    {"controller", "horizon_s", "speed_m_s", "cases", "seed", "variants"});
  testing_support::expect_each_published(merged.at("rows"), published.at("rows"),
                                         {"push", "force_N", "point"});
  testing_support::expect_each_published(merged.at("comparisons"), published.at("comparisons"),
                                         {"from", "to", "cases"});
}

/// Half a second each: a setting that does not arrive would give two runs the same figures.
TEST(PairedExperiment, EveryVariantAndPointOfAPushIsAWalkOfItsOwn) {
  const PairedPlan paired = plan();
  WalkCase walk;
  walk.duration_s = 0.5;
  walk.push_N = 60.0;
  walk.push_start_s = 0.1;
  std::map<double, std::string> names;  // by mean speed
  for (const std::size_t p : {0u, 2u}) {
    ASSERT_NE(paired.pushes[0].point, paired.pushes[2].point);
    for (std::size_t v = 0; v < paired.variants.size(); ++v) {
      const std::string name = paired.pushes[p].point + " " + paired.variants[v].name;
      const auto [other, is_new] = names.emplace(paired.pushes[p].walk[v](walk).summary.mean_speed_m_s, name);
      EXPECT_TRUE(is_new) << name << " walks as " << other->second;
    }
  }
}

class PublishedPairs : public ::testing::TestWithParam<Survived> {};

TEST_P(PublishedPairs, AreSurvivedAtTheGuardedShareOfTheForce) {
  constexpr int kGuardedCases = 3;
  PairedPlan paired = plan();
  PairedPush push = paired.pushes[GetParam().push];
  push.force_N *= kGuardedShare;
  for (int number = 0; number < kGuardedCases; ++number) {
    const WalkCase walk = paired_walk(paired, push, number);
    EXPECT_TRUE(push.walk[GetParam().variant](walk).summary.survived)
        << push.force_N << " N from " << walk.push_start_s << " s, seed " << walk.seed;
  }
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, PublishedPairs, ::testing::ValuesIn(survived_in_half_the_cases()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace stilt::experiments
