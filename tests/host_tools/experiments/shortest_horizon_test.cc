#include "host_tools/experiments/shortest_horizon.h"

#include <gtest/gtest.h>

namespace stilt::experiments {
namespace {

Json rows_of(const std::function<bool(double horizon_s)>& walks) {
  HorizonPlan plan;
  plan.controllers = {"mpc-heuristic"};
  plan.horizons_s = {0.1, 0.2, 0.3, 0.4};
  std::vector<Json> results;
  for (const Job& job : horizon_jobs(plan, [&](const WalkCase& walk) {
         log::RunRecord record;
         record.summary.survived = walks(walk.horizon_s);
         record.summary.fall_time_s = record.summary.survived ? -1.0 : 2.0;
         return record;
       })) {
    results.push_back(job.run());
  }
  return merge_horizons(plan, results).at("rows").at(0);
}

TEST(ShortestHorizon, IsTheOneFromWhichAllLongerOnesWalk) {
  EXPECT_EQ(rows_of([](double h) { return h > 0.25; }).at("shortest_horizon_s"), 0.3);
  EXPECT_EQ(rows_of([](double) { return true; }).at("shortest_horizon_s"), 0.1);
  EXPECT_EQ(rows_of([](double h) { return h < 0.15 || h > 0.35; }).at("shortest_horizon_s"), 0.4)
      << "a walk at 0.1 s is chance when 0.2 and 0.3 s fall";
}

TEST(ShortestHorizon, IsUnknownWhenTheLongestFalls) {
  EXPECT_TRUE(rows_of([](double h) { return h < 0.35; }).at("shortest_horizon_s").is_null());
}

}  // namespace
}  // namespace stilt::experiments
