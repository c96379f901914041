#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "host_tools/cli/friction_experiment.h"
#include "tests/closed_loop/published_plan.h"

/// Joints with Coulomb friction, known to the controller or not: the figures of docs/results/friction.json.
namespace stilt::experiments {
namespace {

using testing_support::published_options;
using testing_support::results_of;

/// A figure of the table is met within this share of it.
constexpr double kSameShare = 0.05;

FrictionPlan published_plan() { return cli::friction_plan(published_options("friction")); }

TEST(PublishedFriction, HasTheConditionsOfTheExperiment) {
  const FrictionPlan today = published_plan();
  const auto jobs = friction_jobs(today, testing_support::no_walk);
  const Json merged = merge_friction(today, testing_support::results_without_walks(jobs));
  testing_support::expect_each_published(
      merged.at("rows"), results_of("friction").at("rows"),
      {"controller", "horizon_s", "friction_Nm", "duration_s", "plan_rate_hz", "plan_delay_s"});
}

class JointError : public ::testing::TestWithParam<Json> {};

TEST_P(JointError, IsThePublishedOneAndUpTo100PlansPerSecondCompensationLeavesThatOfJointsWithout) {
  FrictionPlan plan = published_plan();
  plan.rates = {{GetParam().at("plan_rate_hz"), GetParam().at("plan_delay_s")}};
  const cli::ExperimentOptions options = published_options("friction");
  std::vector<Json> results;
  for (const Job& job : friction_jobs(plan, cli::walk_runner(options.setting))) results.push_back(job.run());
  const Json row = merge_friction(plan, results).at("rows").at(0);
  std::printf("%s\n", row.dump().c_str());
  EXPECT_TRUE(row.at("survived").get<bool>());
  for (const char* field : {"no_friction_rad", "unknown_rad", "configured_rad", "configured_over_unknown"}) {
    const double published = GetParam().at(field).get<double>();
    EXPECT_NEAR(row.at(field).get<double>(), published, kSameShare * published) << field;
  }
  if (plan.rates.front().plan_rate_hz > 100.0) return;  // a plan is too new for friction to show
  const double configured_rad = row.at("configured_rad").get<double>();
  EXPECT_LE(configured_rad, 0.6 * row.at("unknown_rad").get<double>());
  EXPECT_LE(configured_rad, 1.1 * row.at("no_friction_rad").get<double>());
}

INSTANTIATE_TEST_SUITE_P(PlansPerSecond, JointError,
                         ::testing::ValuesIn(results_of("friction").at("rows").get<std::vector<Json>>()),
                         [](const auto& test) {
                           return testing_support::test_name(test.param.at("plan_rate_hz").dump());
                         });

}  // namespace
}  // namespace stilt::experiments
