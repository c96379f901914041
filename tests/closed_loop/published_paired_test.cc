#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "host_tools/cli/paired_experiment.h"
#include "tests/closed_loop/published_plan.h"
#include "tests/closed_loop/published_results.h"

/// The paired pushes of docs/results, with the shipped and with weaker motors. A variant that survived half
/// of the cases of a push survives three of these cases at 85 % of the force.
namespace stilt::experiments {
namespace {

using testing_support::kGuardedShare;
using testing_support::results_of;

constexpr const char* kTables[] = {"paired", "paired_motors"};

/// Numbers of a push and of a variant in the plan of a table.
struct Survived {
  std::string table;
  std::size_t push, variant;
  std::string name;

  friend std::ostream& operator<<(std::ostream& stream, const Survived& one) { return stream << one.name; }
};

PairedPlan plan_of(const std::string& table) {
  return cli::paired_plan(testing_support::published_options(table));
}

std::vector<Survived> survived_in_half_the_cases(const std::string& table) {
  const PairedPlan paired = plan_of(table);
  const Json results = results_of(table);
  std::vector<Survived> all;
  for (std::size_t p = 0; p < paired.pushes.size() && p < results.at("rows").size(); ++p) {
    for (std::size_t v = 0; v < paired.variants.size(); ++v) {
      const Json count = results.at("rows")[p].at("survived").value(paired.variants[v].name, Json());
      if (!count.is_number() || 2 * count.get<int>() < results.at("cases").get<int>()) continue;
      const std::string name = table + "_" + paired.pushes[p].name + "_" + paired.variants[v].name;
      all.push_back({table, p, v, testing_support::test_name(name)});
    }
  }
  return all;
}

std::vector<Survived> all_survived_in_half_the_cases() {
  std::vector<Survived> all;
  for (const char* table : kTables)
    std::ranges::move(survived_in_half_the_cases(table), std::back_inserter(all));
  return all;
}

TEST(PublishedTables, HaveResultsOfThePairedPushes) {
  for (const char* table : kTables) {
    EXPECT_EQ(results_of(table).at("rows").size(), plan_of(table).pushes.size()) << table;
  }
  EXPECT_EQ(survived_in_half_the_cases("paired").size(), 12u);
  EXPECT_EQ(survived_in_half_the_cases("paired_motors").size(), 8u);
}

/// What is guarded is what was measured.
TEST(PublishedTables, HaveTheConditionsOfThePairedPushes) {
  for (const char* table : kTables) {
    SCOPED_TRACE(table);
    PairedPlan today = plan_of(table);
    for (PairedPush& push : today.pushes) {
      for (WalkRunner& walk : push.walk) walk = testing_support::no_walk;
    }
    const Json merged = merge_paired(today, testing_support::results_without_walks(paired_jobs(today)));
    const Json published = results_of(table);
    testing_support::expect_published(merged, published,
                                      {"controller", "horizon_s", "speed_m_s", "cases", "seed", "variants"});
    testing_support::expect_each_published(merged.at("rows"), published.at("rows"),
                                           {"push", "force_N", "point"});
    testing_support::expect_each_published(merged.at("comparisons"), published.at("comparisons"),
                                           {"from", "to", "cases"});
  }
}

/// Half a second each: a setting that does not arrive would give two runs the same figures.
TEST(PairedExperiment, EveryVariantAndPointOfAPushIsAWalkOfItsOwn) {
  const PairedPlan paired = plan_of("paired");
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
  const PairedPlan paired = plan_of(GetParam().table);
  PairedPush push = paired.pushes[GetParam().push];
  push.force_N *= kGuardedShare;
  for (int number = 0; number < kGuardedCases; ++number) {
    const WalkCase walk = paired_walk(paired, push, number);
    EXPECT_TRUE(push.walk[GetParam().variant](walk).summary.survived)
        << push.force_N << " N from " << walk.push_start_s << " s, seed " << walk.seed;
  }
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, PublishedPairs, ::testing::ValuesIn(all_survived_in_half_the_cases()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace stilt::experiments
