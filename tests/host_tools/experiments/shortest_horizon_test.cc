#include "host_tools/experiments/shortest_horizon.h"

#include <gtest/gtest.h>

#include <set>

namespace stilt::experiments {
namespace {

/// Speed of a made-up robot at a horizon under a seed; nothing: it falls after 2 s plus the seed.
using Robot = std::function<std::optional<double>(double horizon_s, std::uint64_t seed)>;

HorizonPlan plan_of(int seeds) {
  HorizonPlan plan;
  plan.controllers = {"mpc-heuristic"};
  plan.horizons_s = {0.1, 0.2, 0.3, 0.4};
  plan.seeds = seeds;
  return plan;
}

Json merged(const Robot& robot, int seeds = 1) {
  const HorizonPlan plan = plan_of(seeds);
  std::vector<Json> results;
  for (const Job& job : horizon_jobs(plan, [&](const WalkCase& walk) {
         const auto speed_m_s = robot(walk.horizon_s, walk.seed);
         log::RunRecord record;
         record.summary.survived = speed_m_s.has_value();
         record.summary.fall_time_s = speed_m_s ? -1.0 : 2.0 + static_cast<double>(walk.seed);
         record.summary.mean_speed_m_s = speed_m_s.value_or(3.0);
         // Before it has settled the other way round.
         record.summary.steps = {
             {1.0, "L", 0.1, 0.0}, {31.0, "L", 0.3, 0.0}, {31.5, "R", 0.02, 0.0}, {32.0, "L", 0.5, 0.0}};
         return record;
       })) {
    results.push_back(job.run());
  }
  return merge_horizons(plan, results);
}

Json row_of(const std::function<bool(double horizon_s)>& walks) {
  return merged([&](double horizon_s, std::uint64_t) {
           return walks(horizon_s) ? std::optional(0.5) : std::nullopt;
         })
      .at("rows")
      .at(0);
}

TEST(ShortestHorizon, IsTheOneFromWhichAllLongerOnesWalk) {
  EXPECT_EQ(row_of([](double h) { return h > 0.25; }).at("shortest_horizon_s"), 0.3);
  EXPECT_EQ(row_of([](double) { return true; }).at("shortest_horizon_s"), 0.1);
  EXPECT_EQ(row_of([](double h) { return h < 0.15 || h > 0.35; }).at("shortest_horizon_s"), 0.4)
      << "a walk at 0.1 s is chance when 0.2 and 0.3 s fall";
}

TEST(ShortestHorizon, EveryHorizonHasJobsOfItsOwn) {
  HorizonPlan plan = plan_of(1);
  plan.horizons_s = {0.201, 0.204, 0.05 * 3, 0.5};
  std::vector<std::string> ids;
  for (const Job& job : horizon_jobs(plan, {})) ids.push_back(job.id);
  EXPECT_EQ(ids, (std::vector<std::string>{"mpc-heuristic_0.201s_seed1", "mpc-heuristic_0.204s_seed1",
                                           "mpc-heuristic_0.15s_seed1", "mpc-heuristic_0.50s_seed1"}));
}

TEST(ShortestHorizon, IsUnknownWhenTheLongestFalls) {
  const Json row = row_of([](double h) { return h < 0.35; });
  EXPECT_TRUE(row.at("shortest_horizon_s").is_null());
  EXPECT_TRUE(row.at("mean_speed_m_s").is_null());
}

TEST(ShortestHorizon, IsNotOneThatStaysOnItsFeetAtAnotherSpeed) {
  const Json result = merged([](double horizon_s, std::uint64_t) { return horizon_s < 0.25 ? 0.745 : 0.51; });
  const Json& row = result.at("rows").at(0);
  EXPECT_EQ(row.at("shortest_horizon_s"), 0.3);
  EXPECT_EQ(row.at("mean_speed_m_s"), 0.51);
  const Json& second = row.at("tried").at(1);
  EXPECT_EQ(second.at("survived"), true);
  EXPECT_EQ(second.at("walks"), false);
  EXPECT_EQ(second.at("mean_speed_m_s"), 0.745);
  EXPECT_NE(horizon_table(result).find("0.10 (0.745 m/s), 0.20 (0.745 m/s)"), std::string::npos)
      << horizon_table(result);
}

TEST(ShortestHorizon, ShowsALimp) {
  const Json result = merged(
      [](double horizon_s, std::uint64_t) { return horizon_s < 0.15 ? std::nullopt : std::optional(0.5); });
  const Json& row = result.at("rows").at(0);
  EXPECT_DOUBLE_EQ(row.at("step_length_left_m"), 0.4);
  EXPECT_EQ(row.at("step_length_right_m"), 0.02);
  EXPECT_TRUE(row.at("tried").at(0).at("step_length_left_m").is_null()) << "it falls";
  EXPECT_NE(horizon_table(result).find("| 0.500 | 0.400, 0.020 |"), std::string::npos)
      << horizon_table(result);
}

TEST(ShortestHorizon, WalksWithEverySeed) {
  const Json result = merged(
      [](double horizon_s, std::uint64_t seed) {
        return horizon_s < 0.25 && seed != 3 ? std::nullopt : std::optional(0.49);
      },
      3);
  const Json& row = result.at("rows").at(0);
  EXPECT_EQ(row.at("shortest_horizon_s"), 0.3);
  EXPECT_EQ(row.at("seeds"), 3);
  const Json& second = row.at("tried").at(1);
  EXPECT_EQ(second.at("survived"), false);
  EXPECT_EQ(second.at("fall_time_s"), 3.0) << "of the earliest fall";
  EXPECT_EQ(second.at("mean_speed_m_s"), 0.49) << "of the seed that survives";
  EXPECT_NE(horizon_table(result).find("0.20 (falls after 3.0 s)"), std::string::npos);
}

TEST(ShortestHorizon, EverySeedIsAJobWithANameOfItsOwn) {
  std::set<std::string> names;
  for (const Job& job : horizon_jobs(plan_of(3), {})) names.insert(job.id);
  EXPECT_EQ(names.size(), 4u * 3u);
}

}  // namespace
}  // namespace stilt::experiments
