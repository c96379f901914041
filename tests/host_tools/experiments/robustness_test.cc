#include "host_tools/experiments/robustness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "host_tools/experiments/robustness_page.h"
#include "host_tools/simulation/plant/plant_options.h"

namespace stilt::experiments {
namespace {

simulation::PlantOptions world_of(const WalkCase& walk) {
  simulation::PlantOptions world;
  for (const std::string& assignment : walk.plant) simulation::set_plant_option(world, assignment);
  return world;
}

/// A made-up robot that falls on slippery ground, the earlier the more slippery it is. Otherwise its margin
/// falls with the slope in either direction.
log::RunRecord walk_of(const WalkCase& walk) {
  const simulation::PlantOptions world = world_of(walk);
  log::RunRecord record;
  record.summary.survived = world.friction > 0.41;
  record.summary.fall_time_s = record.summary.survived ? -1.0 : 10.0 * world.friction;
  record.summary.fall_margin_min =
      record.summary.survived ? 0.9 - 10.0 * std::abs(world.ground_slope_rad) : -0.01;
  record.summary.mean_speed_m_s = 0.5;
  return record;
}

RobustnessPlan plan_of(int runs) {
  RobustnessPlan plan;
  plan.runs = runs;
  plan.quantities = random_quantities(std::nullopt);
  plan.command = [](const WalkCase& walk) { return "stilt sim <" + std::to_string(walk.seed) + ">"; };
  return plan;
}

std::vector<Json> results_of(const RobustnessPlan& plan) {
  std::vector<Json> results;
  for (const Job& job : robustness_jobs(plan, walk_of)) results.push_back(job.run());
  return results;
}

const Json& quantity(const Json& merged, const char* name) {
  const auto& all = merged.at("quantities");
  return *std::ranges::find_if(all, [&](const Json& one) { return one.at("name") == name; });
}

TEST(Robustness, ARunIsTheSameWhateverTheNumberOfRuns) {
  const auto few = robustness_jobs(plan_of(3), walk_of), many = robustness_jobs(plan_of(30), walk_of);
  EXPECT_EQ(many.size(), 30u);
  EXPECT_EQ(few[2].id, "seed1_run0002");
  EXPECT_EQ(many[2].id, few[2].id);
  EXPECT_EQ(many[2].run(), few[2].run());
  RobustnessPlan other = plan_of(3);
  other.seed = 2;
  EXPECT_NE(robustness_jobs(other, walk_of)[2].run().at("changes"), few[2].run().at("changes"));
}

TEST(Robustness, SurvivorsAreCountedAndTheWorstAreFallsThenSmallMargins) {
  const RobustnessPlan plan = plan_of(300);
  const std::vector<Json> results = results_of(plan);
  const Json merged = merge_robustness(plan, results);
  const auto falls = std::ranges::count_if(
      results, [](const Json& one) { return one.at("changes").at("friction").get<double>() <= 0.41; });
  ASSERT_GT(falls, 1);
  ASSERT_LT(falls, 10) << "so that runs without a fall are among the ten worst";
  EXPECT_EQ(merged.at("runs"), 300);
  EXPECT_EQ(merged.at("survived"), 300 - falls);
  EXPECT_NEAR(merged.at("survival").at("value").get<double>(), 1.0 - static_cast<double>(falls) / 300.0,
              1e-12);
  const Json& worst = merged.at("worst");
  ASSERT_EQ(worst.size(), 10u);
  for (std::size_t i = 0; i + 1 < worst.size(); ++i) {
    const bool fell = i < static_cast<std::size_t>(falls);
    EXPECT_EQ(worst[i].at("survived"), !fell) << i;
    const char* key = fell ? "fall_time_s" : "fall_margin_min";
    if (worst[i].at("survived") == worst[i + 1].at("survived")) {
      EXPECT_LE(worst[i].at(key), worst[i + 1].at(key));
    }
  }
  double smallest = 1.0;
  for (const Json& one : results) {
    if (one.at("survived").get<bool>())
      smallest = std::min(smallest, one.at("fall_margin_min").get<double>());
  }
  EXPECT_EQ(worst[static_cast<std::size_t>(falls)].at("fall_margin_min"), smallest);
}

TEST(Robustness, WhatFellsTheRobotsCorrelatesAndNothingElseDoes) {
  const RobustnessPlan plan = plan_of(500);
  const Json merged = merge_robustness(plan, results_of(plan));
  const Json& friction = quantity(merged, "friction");
  EXPECT_LT(friction.at("falls").at("high").get<double>(), 0.0) << friction;
  const Json& slope = quantity(merged, "ground_slope_rad");
  EXPECT_LT(slope.at("distance").at("value").get<double>(), -0.9) << slope;
  EXPECT_NEAR(slope.at("margin").at("value").get<double>(), 0.0, 0.15) << "uphill is as hard as downhill";
  for (const Json& one : merged.at("quantities")) {
    const auto name = one.at("name").get<std::string>();
    if (name == "friction" || name == "ground_slope_rad" || name == "slope_as_read_rad") continue;
    EXPECT_LT(std::abs(one.at("margin").at("value").get<double>()), 0.2) << one;
    EXPECT_LT(std::abs(one.at("falls").at("value").get<double>()), 0.2) << one;
  }
  const Json& read = quantity(merged, "slope_as_read_rad");
  EXPECT_LT(read.at("distance").at("value").get<double>(), -0.5) << "mostly slope, and a bias without effect";
  EXPECT_TRUE(quantity(merged, "joint_friction_Nm").at("distance").is_null())
      << "nominal at an end: the distance is the value";
}

TEST(Robustness, ASensorThatReadsTheTorsoLeaningBackReadsASteeperClimb) {
  const Json result = {{"changes", {{"ground_slope_rad", 0.03}, {"base_pitch_bias_rad", -0.02}}}};
  EXPECT_NEAR(value_of("slope_as_read_rad", result), 0.05, 1e-12);
  EXPECT_EQ(value_of("ground_slope_rad", result), 0.03);
}

TEST(Robustness, WithoutAFallNothingCorrelatesWithFalling) {
  RobustnessPlan plan = plan_of(20);
  std::vector<Json> results;
  for (const Job& job : robustness_jobs(plan, [](const WalkCase& walk) {
         log::RunRecord record = walk_of(walk);
         record.summary.survived = true;
         return record;
       })) {
    results.push_back(job.run());
  }
  const Json merged = merge_robustness(plan, results);
  EXPECT_EQ(merged.at("survived"), 20);
  for (const Json& one : merged.at("quantities")) EXPECT_TRUE(one.at("falls").is_null());
  EXPECT_EQ(robustness_page(merged, results).find("nan"), std::string::npos);
}

TEST(Robustness, ThePageLinksTheWorstRunsAndEscapesTheirCommands) {
  const RobustnessPlan plan = plan_of(40);
  const std::vector<Json> results = results_of(plan);
  const Json merged = merge_robustness(plan, results);
  const std::string page = robustness_page(merged, results);
  for (const Json& one : merged.at("worst")) {
    EXPECT_NE(page.find("href='" + one.at("page").get<std::string>() + "'"), std::string::npos) << one;
    EXPECT_NE(page.find("stilt sim &lt;" + std::to_string(one.at("seed").get<std::uint32_t>()) + "&gt;"),
              std::string::npos);
  }
  EXPECT_EQ(page.find("nan"), std::string::npos);
  int dots = 0;
  for (std::size_t at = page.find("h0"); at != std::string::npos; at = page.find("h0", at + 1)) ++dots;
  EXPECT_EQ(dots, 12 * 40) << "each run is a dot in each of twelve plots";
  const std::string commands = commands_text(results);
  EXPECT_EQ(std::ranges::count(commands, '\n'), 40);
  EXPECT_NE(robustness_table(merged).find(" of 40 random robots stay on their feet"), std::string::npos);
}

}  // namespace
}  // namespace stilt::experiments
