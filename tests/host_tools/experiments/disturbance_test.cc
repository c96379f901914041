#include "host_tools/experiments/disturbance.h"

#include <gtest/gtest.h>

#include <set>

namespace stilt::experiments {
namespace {

/// Two rows, two phases, two seeds, and a robot that survives a force that depends on them.
DisturbancePlan small_plan() {
  DisturbancePlan plan;
  plan.rows = {{"mpc-heuristic", 2.0}, {"mpc-none", 0.5}};
  plan.phases = 2;
  plan.seeds = 2;
  plan.search.largest_N = 100.0;
  return plan;
}

log::RunRecord walk_of(const WalkCase& walk) {
  const bool second_phase = walk.push_start_s > 4.3;
  const double limit_N =
      walk.controller == "mpc-none" ? -1.0 : 20.0 + 7.0 * second_phase + static_cast<double>(walk.seed);
  log::RunRecord record;
  record.summary.survived = walk.push_N <= limit_N;
  record.summary.fall_time_s = record.summary.survived ? -1.0 : walk.push_start_s + 1.0;
  record.summary.step_length_min_m = 0.1;
  record.summary.step_length_max_m = 0.2 + 0.01 * walk.push_N;
  record.summary.slip_distance_m = 0.002 + (walk.push_N > 24.5 ? 0.02 : 0.0);
  record.summary.saturated_s = 0.001 * walk.push_N;
  return record;
}

std::vector<Json> results_of(const DisturbancePlan& plan) {
  std::vector<Json> results;
  for (const Job& job : disturbance_jobs(plan, walk_of)) results.push_back(job.run());
  return results;
}

TEST(Disturbance, ARowHasTheSmallestLimitAndThatOfHalfTheCases) {
  const DisturbancePlan plan = small_plan();
  const Json row = merge_disturbance(plan, results_of(plan)).at("rows").at(0);
  EXPECT_EQ(row.at("limits_N"), Json({21.0, 22.0, 28.0, 29.0}));
  EXPECT_EQ(row.at("push_all_phases_N"), 21.0);
  EXPECT_EQ(row.at("push_half_phases_N"), 28.0) << "two of four cases reach it";
  EXPECT_EQ(row.at("paper_N"), 22.0);
  EXPECT_EQ(row.at("cases"), 4);
  EXPECT_EQ(row.at("walks"), 4);
  EXPECT_NEAR(row.at("step_length_range_m").get<double>(), 0.2 + 0.29 - 0.1, 1e-12);
  EXPECT_NEAR(row.at("saturated_s").get<double>(), 0.029, 1e-12);
  EXPECT_EQ(row.at("first_slip_N"), 25.0) << "the smallest that was tried and slipped";
}

TEST(Disturbance, ARowThatFallsUnpushedHasNoForces) {
  const DisturbancePlan plan = small_plan();
  const Json row = merge_disturbance(plan, results_of(plan)).at("rows").at(1);
  EXPECT_TRUE(row.at("push_all_phases_N").is_null());
  EXPECT_TRUE(row.at("push_half_phases_N").is_null());
  EXPECT_TRUE(row.at("step_length_range_m").is_null());
  EXPECT_TRUE(row.at("paper_N").is_null());
  EXPECT_EQ(row.at("walks"), 0);
}

TEST(Disturbance, EveryCaseIsAJobWithANameOfItsOwn) {
  DisturbancePlan plan;
  plan.rows = published_rows();
  std::set<std::string> names;
  for (const Job& job : disturbance_jobs(plan, walk_of)) names.insert(job.id);
  EXPECT_EQ(names.size(), 13u * 8u * 3u);
  plan.phases = 4;  // other times of the push, so other results
  for (const Job& job : disturbance_jobs(plan, walk_of)) EXPECT_FALSE(names.contains(job.id));
}

TEST(Disturbance, PhasesSpreadOverStepsOfBothFeet) {
  const DisturbancePlan plan;
  const DisturbancePlan::Row row;
  const double first_s = push_start_s(plan, row, 0);
  EXPECT_GE(first_s, plan.settled_s);
  for (int phase = 0; phase < plan.phases; ++phase) {
    const double steps = (push_start_s(plan, row, phase) - first_s) / row.step_s;
    EXPECT_NEAR(steps, phase % 2 + phase / 8.0, 1e-9);
  }
}

TEST(Disturbance, TheTableHasALineForEveryRow) {
  const DisturbancePlan plan = small_plan();
  const std::string table = disturbance_table(merge_disturbance(plan, results_of(plan)));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
  EXPECT_NE(table.find("| mpc-heuristic | 2.0 | 21 | 28 | 22 |"), std::string::npos) << table;
  EXPECT_NE(table.find("| mpc-none | 0.5 | falls unpushed |"), std::string::npos) << table;
}

}  // namespace
}  // namespace stilt::experiments
