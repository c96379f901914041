#include "host_tools/experiments/robustness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "host_tools/cli/robustness_experiment.h"
#include "tests/closed_loop/published_plan.h"
#include "tests/closed_loop/published_results.h"

/// Random robots and worlds that the controller has no model of (`stilt experiment robustness`).
namespace stilt::experiments {
namespace {

using testing_support::results_of;

constexpr const char* kTables[] = {"robustness", "robustness_motors"};

/// By names, because the published order is that of the correlations.
Json by(const char* key, const Json& list) {
  auto sorted = list.get<std::vector<Json>>();
  std::sort(sorted.begin(), sorted.end(),
            [key](const Json& a, const Json& b) { return a.at(key) < b.at(key); });
  return sorted;
}

/// What is guarded is what was measured: quantities, their ranges, and robots and commands of the worst runs.
TEST(PublishedTables, HaveTheConditionsOfTheRandomRobots) {
  for (const char* table : kTables) {
    SCOPED_TRACE(table);
    const Json published = results_of(table);
    RobustnessPlan today = cli::robustness_plan(testing_support::published_options(table));
    const auto jobs = robustness_jobs(today, testing_support::no_walk);
    today.worst = today.runs;
    const Json merged = merge_robustness(today, testing_support::results_without_walks(jobs));
    testing_support::expect_published(merged, published,
                                      {"controller", "horizon_s", "speed_m_s", "force_N", "seed", "runs"});
    testing_support::expect_each_published(by("name", merged.at("quantities")),
                                           by("name", published.at("quantities")),
                                           {"name", "words", "unit", "low", "high", "nominal"});
    EXPECT_EQ(published.at("worst").size(), 10u);
    const Json runs = by("run", merged.at("worst"));
    for (const Json& worst : published.at("worst")) {
      testing_support::expect_published(runs.at(worst.at("run").get<std::size_t>()), worst,
                                        {"run", "seed", "changes", "command", "page"});
    }
  }
}

TEST(PublishedRobots, TheTwoWithTheSmallestMarginsSurviveAgain) {
  for (const char* table : kTables) {
    SCOPED_TRACE(table);
    const cli::ExperimentOptions options = testing_support::published_options(table);
    const auto jobs = robustness_jobs(cli::robustness_plan(options), cli::walk_runner(options.setting));
    const Json published = results_of(table).at("worst");
    for (std::size_t place = 0; place < 2; ++place) {
      const Json result = jobs.at(published.at(place).at("run").get<std::size_t>()).run();
      EXPECT_EQ(result.at("survived"), published.at(place).at("survived"))
          << "falls at " << result.at("fall_time_s") << " s: " << result.at("command").get<std::string>();
    }
  }
}

TEST(Robustness, TwoDozenRandomRobotsSurviveAPushOfFortyNewtons) {
  cli::ExperimentOptions options;
  options.runs = 24;
  options.seed = 20260;  // a seed of its own, not that of docs/results
  const RobustnessPlan plan = cli::robustness_plan(options);
  const WalkRunner run = cli::walk_runner(options.setting);
  for (const Job& job : robustness_jobs(plan, run)) {
    const Json result = job.run();
    EXPECT_EQ(result.at("survived"), true)
        << "falls at " << result.at("fall_time_s") << " s: " << result.at("command").get<std::string>();
  }
}

}  // namespace
}  // namespace stilt::experiments
