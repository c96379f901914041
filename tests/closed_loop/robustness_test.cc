#include "host_tools/experiments/robustness.h"

#include <gtest/gtest.h>

#include <vector>

#include "host_tools/cli/robustness_experiment.h"

/// Random robots and worlds that the controller has no model of (`stilt experiment robustness`).
namespace stilt::experiments {
namespace {

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
