#include "host_tools/experiments/disturbance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace stilt::experiments {
namespace {

/// What a made-up robot does in a case; it begins to walk with steps of 0.9 m, then 0.1 m and longer under
/// a push. It slips 20 mm without a push and 20 mm more from 24.5 N on, and falls when the push is too
/// large.
log::RunRecord walk_of(const WalkCase& walk) {
  const bool second_phase = walk.push_start_s > 4.3;
  const double limit_N =
      walk.controller == "mpc-none" ? -1.0 : 20.0 + 7.0 * second_phase + static_cast<double>(walk.seed);
  log::RunRecord record;
  log::RunSummary& summary = record.summary;
  summary.survived = walk.push_N <= limit_N;
  summary.fall_time_s = summary.survived ? -1.0 : walk.push_start_s + 1.0;
  summary.mean_speed_m_s = walk.controller == "mpc-lumped" ? 0.707 : 0.5 + 0.01 * walk.push_N;
  summary.slip_distance_m = 0.02 + (walk.push_N > 24.5 ? 0.02 : 0.0);
  summary.saturated_s = 0.001 * walk.push_N;
  const double speed_m_s = walk.controller == "mpc-lumped" ? 0.707 : 0.5;
  double hip_x_m = 0.0;
  for (double time_s = 0.3; time_s < walk.duration_s; time_s += 0.3) {
    const bool starting = time_s < 2.0;
    const bool pushed = time_s > walk.push_start_s && time_s < walk.push_start_s + 1.5;
    summary.steps.push_back(
        {time_s, "L", starting ? 0.9 : 0.1 + (pushed ? 0.01 * walk.push_N : 0.0), hip_x_m});
    hip_x_m += 0.3 * (speed_m_s + (pushed ? 0.02 * walk.push_N : 0.0));
  }
  return record;
}

PushRow row_of(const std::string& name, const std::string& controller, double horizon_s) {
  PushRow row;
  row.name = name;
  row.controller = controller;
  row.horizon_s = horizon_s;
  row.phases = 2;
  row.seeds = 2;
  row.search.largest_N = 100.0;
  row.walk = walk_of;
  return row;
}

/// Two phases, two seeds, and limits of 21, 22, 28 and 29 N for those that do not fall unpushed.
DisturbancePlan small_plan() {
  DisturbancePlan plan;
  plan.rows = {row_of("a", "mpc-heuristic", 2.0), row_of("b", "mpc-none", 0.5),
               row_of("c", "mpc-lumped", 0.5)};
  return plan;
}

Json merged(const DisturbancePlan& plan) {
  std::vector<Json> results;
  for (const Job& job : disturbance_jobs(plan)) results.push_back(job.run());
  return merge_disturbance(plan, results);
}

Json only_row(const PushRow& row) {
  DisturbancePlan plan;
  plan.rows = {row};
  return merged(plan).at("rows").at(0);
}

TEST(Disturbance, ARowHasTheSmallestLimitAndThatOfHalfTheCases) {
  const Json row = merged(small_plan()).at("rows").at(0);
  EXPECT_EQ(row.at("name"), "a");
  EXPECT_EQ(row.at("limits_N"), Json({21.0, 22.0, 28.0, 29.0}));
  EXPECT_EQ(row.at("push_all_phases_N"), 21.0);
  EXPECT_EQ(row.at("push_half_phases_N"), 28.0) << "two of four cases reach it";
  EXPECT_EQ(row.at("worst_cases"), Json({{{"phase", 0}, {"seed", 1}, {"limit_N", 21.0}},
                                         {{"phase", 0}, {"seed", 2}, {"limit_N", 22.0}}}));
  EXPECT_EQ(row.at("paper_N"), 22.0);
  EXPECT_EQ(row.at("cases"), 4);
  EXPECT_NEAR(row.at("saturated_s").get<double>(), 0.029, 1e-12);
}

TEST(Disturbance, ARowThatFallsUnpushedHasNoForces) {
  const Json row = merged(small_plan()).at("rows").at(1);
  for (const char* field : {"push_all_phases_N", "push_half_phases_N", "step_length_range_m", "paper_N",
                            "unpushed_speed_m_s", "step_length_at_20N_m", "first_slip_N"}) {
    EXPECT_TRUE(row.at(field).is_null()) << field;
  }
  EXPECT_EQ(row.at("walks"), false);
  EXPECT_EQ(row.at("cases_walk"), 0);
  EXPECT_TRUE(row.at("recovery_steps").at("at_20N").is_null());
  EXPECT_TRUE(row.at("recovery_steps").at("at_80_percent").is_null());
}

TEST(Disturbance, ARowSaysWhetherItWalksAtTheCommandWithoutAPush) {
  const Json rows = merged(small_plan()).at("rows");
  EXPECT_EQ(rows[0].at("unpushed_speed_m_s"), 0.5) << "pushed runs are faster and do not count";
  EXPECT_EQ(rows[0].at("walks"), true);
  EXPECT_EQ(rows[0].at("cases_walk"), 4);
  EXPECT_NEAR(rows[2].at("unpushed_speed_m_s").get<double>(), 0.707, 1e-12);
  EXPECT_EQ(rows[2].at("walks"), false);
  EXPECT_EQ(rows[2].at("cases_walk"), 0);
  EXPECT_EQ(rows[2].at("push_all_phases_N"), 21.0) << "it stays on its feet all the same";
}

TEST(Disturbance, ARowWalksWhenEveryCaseDoes) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.walk = [](const WalkCase& walk) {
    log::RunRecord record = walk_of(walk);
    if (walk.seed == 2 && walk.push_start_s < 4.3) record.summary.mean_speed_m_s = 0.4;
    return record;
  };
  const Json json = only_row(row);
  EXPECT_EQ(json.at("walks"), false);
  EXPECT_EQ(json.at("cases_walk"), 3);
}

TEST(Disturbance, RecoveryIsToTheSpeedWithoutAPushNotToTheCommand) {
  const Json lumped = merged(small_plan()).at("rows").at(2);
  EXPECT_EQ(lumped.at("recovery_steps").at("at_20N").at("recovered"), 4) << "0.707 m/s, commanded 0.5 m/s";
}

TEST(Disturbance, StepLengthsCountFromTheStartOfThePushOn) {
  const Json row = merged(small_plan()).at("rows").at(0);
  EXPECT_NEAR(row.at("step_length_min_m").get<double>(), 0.1, 1e-12);
  EXPECT_NEAR(row.at("step_length_max_m").get<double>(), 0.1 + 0.29, 1e-12) << "the start had 0.9 m";
  EXPECT_NEAR(row.at("step_length_range_m").get<double>(), 0.29, 1e-12);
  EXPECT_NEAR(row.at("step_length_at_20N_m").at("min").get<double>(), 0.1, 1e-12);
  EXPECT_NEAR(row.at("step_length_at_20N_m").at("max").get<double>(), 0.3, 1e-12);
  EXPECT_NEAR(row.at("step_length_at_20N_m").at("range").get<double>(), 0.2, 1e-12);
}

TEST(Disturbance, FiguresAtTwentyNewtonsNeedThatForce) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.search.coarse_N = 15.0;
  EXPECT_TRUE(only_row(row).at("step_length_at_20N_m").is_null());
  EXPECT_TRUE(only_row(row).at("recovery_steps").at("at_20N").is_null());
}

TEST(Disturbance, SlipIsThatOfTheUnpushedRunTakenOff) {
  const Json row = merged(small_plan()).at("rows").at(0);
  EXPECT_EQ(row.at("first_slip_N"), 25.0) << "20 mm of slip without a push do not come from the push";
}

TEST(Disturbance, MeasuresFromTheStartOfThePush) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.walk = [](const WalkCase& walk) {
    EXPECT_EQ(walk.measure_from_s, walk.push_start_s);
    EXPECT_GT(walk.push_start_s, 4.0);
    return walk_of(walk);
  };
  (void)only_row(row);
}

TEST(Disturbance, RecoveryIsCountedAtTwentyNewtonsAndAtMostOfTheLimit) {
  // The made-up robot keeps the speed of the push for 0.5 s after it: 0.5 m/s and 0.02 m/s a newton.
  const Json row = merged(small_plan()).at("rows").at(0);
  const Json& at_20N = row.at("recovery_steps").at("at_20N");
  EXPECT_EQ(at_20N.at("cases"), 4);
  EXPECT_EQ(at_20N.at("recovered"), 4);
  EXPECT_GE(at_20N.at("median").get<int>(), 1);
  EXPECT_LE(at_20N.at("max").get<int>(), 3);
  const Json& most = row.at("recovery_steps").at("at_80_percent");
  EXPECT_EQ(most.at("force_N"), 10.0) << "80 % of 21 N, down to a force that every case was pushed with";
  EXPECT_EQ(most.at("cases"), 4);
}

TEST(Disturbance, ACaseThatDoesNotRecoverIsNotHidden) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.walk = [](const WalkCase& walk) {
    log::RunRecord record = walk_of(walk);
    if (walk.push_N > 0.0 && walk.seed == 1) {
      for (log::Step& step : record.summary.steps) step.hip_x_m *= 2.0;
    }
    return record;
  };
  const Json at_20N = only_row(row).at("recovery_steps").at("at_20N");
  EXPECT_EQ(at_20N.at("cases"), 4);
  EXPECT_EQ(at_20N.at("recovered"), 2);
  EXPECT_TRUE(at_20N.at("max").is_null());
}

TEST(Disturbance, ABackwardPushIsNegativeAndItsLimitIsPositive) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.backward = true;
  row.walk = [](const WalkCase& walk) {
    EXPECT_LE(walk.push_N, 0.0);
    log::RunRecord record = walk_of(walk);
    record.summary.survived = walk.push_N >= -33.0;
    return record;
  };
  const Json json = only_row(row);
  EXPECT_EQ(json.at("push_all_phases_N"), 33.0);
  EXPECT_EQ(json.at("direction"), "backward");
  EXPECT_TRUE(json.at("paper_N").is_null()) << "the paper pushes forward";
}

TEST(Disturbance, AStandingRobotWalksWhenItStandsWithoutAStep) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.command = {gait::GaitKind::stand, 0.5};
  row.walk = [](const WalkCase& walk) {
    EXPECT_EQ(walk.command.kind, gait::GaitKind::stand);
    log::RunRecord record;
    record.summary.survived = walk.push_N <= 25.0;
    return record;
  };
  const Json standing = only_row(row);
  EXPECT_EQ(standing.at("walks"), true);
  EXPECT_EQ(standing.at("gait"), "stand");
  EXPECT_EQ(standing.at("speed_m_s"), 0.0);
  EXPECT_TRUE(standing.at("step_length_range_m").is_null());
  EXPECT_TRUE(standing.at("recovery_steps").at("at_20N").is_null());
  EXPECT_TRUE(standing.at("paper_N").is_null());
  row.walk = [](const WalkCase& walk) {
    log::RunRecord record;
    record.summary.survived = walk.push_N <= 25.0;
    record.summary.steps.push_back({3.0, "L", 0.1, 0.0});
    return record;
  };
  EXPECT_EQ(only_row(row).at("walks"), false);
}

TEST(Disturbance, ARowCarriesItsSetting) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.setting = {{"push_at", "torso"}, {"set", {"cost.terminal=1"}}};
  const Json json = only_row(row);
  EXPECT_EQ(json.at("push_at"), "torso");
  EXPECT_EQ(json.at("set"), Json::array({"cost.terminal=1"}));
  EXPECT_EQ(json.at("seeds"), 2);
}

TEST(Disturbance, ThePaperPushesAtTheHip) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.setting = {{"push_at", "hip"}};
  EXPECT_EQ(only_row(row).at("paper_N"), 22.0);
  row.setting = {{"push_at", "torso"}};
  EXPECT_TRUE(only_row(row).at("paper_N").is_null());
}

TEST(Disturbance, ThePaperHasNoRowOfAnotherRobot) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.robot = "rabbit";
  EXPECT_TRUE(only_row(row).at("paper_N").is_null());
}

TEST(Disturbance, EachForceIsWalkedOnce) {
  PushRow row = row_of("a", "mpc-heuristic", 2.0);
  row.phases = row.seeds = 1;
  std::multiset<double> forces_N;
  row.walk = [&](const WalkCase& walk) {
    forces_N.insert(walk.push_N);
    return walk_of(walk);
  };
  (void)only_row(row);
  EXPECT_EQ(forces_N.size(), std::set<double>(forces_N.begin(), forces_N.end()).size());
}

TEST(Disturbance, EveryCaseIsAJobWithANameOfItsOwn) {
  DisturbancePlan plan = small_plan();
  for (PushRow& row : plan.rows) row.phases = 8;
  std::set<std::string> names;
  for (const Job& job : disturbance_jobs(plan)) names.insert(job.id);
  EXPECT_EQ(names.size(), 3u * 8u * 2u);
  for (PushRow& row : plan.rows) row.phases = 4;  // other times of the push, so other results
  for (const Job& job : disturbance_jobs(plan)) EXPECT_FALSE(names.contains(job.id));
}

TEST(Disturbance, PublishedRowsAreFiveControllersAtThreeHorizons) {
  const auto rows = published_rows();
  EXPECT_EQ(rows.size(), 13u);
  EXPECT_EQ(std::ranges::count(rows, std::string("hzd-pd"), &PublishedRow::controller), 1);
}

TEST(Disturbance, PhasesSpreadOverStepsOfBothFeet) {
  const DisturbancePlan plan;
  const PushRow row;
  const double first_s = push_start_s(plan, row, 0);
  EXPECT_GE(first_s, plan.settled_s);
  for (int phase = 0; phase < row.phases; ++phase) {
    const double steps = (push_start_s(plan, row, phase) - first_s) / row.step_time_s;
    EXPECT_NEAR(steps, phase % 2 + phase / 8.0, 1e-9);
  }
}

TEST(Disturbance, TheTableHasALineForEveryRow) {
  const std::string table = disturbance_table(merged(small_plan()));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 5);
  EXPECT_NE(table.find("| a | mpc-heuristic | 2.0 | walk 0.5 | hip forward | 0.500 | yes | 21 | 28 | 22 |"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("| no | falls unpushed |"), std::string::npos) << table;
  EXPECT_NE(table.find("| 0.707 | no |"), std::string::npos) << table;
}

}  // namespace
}  // namespace stilt::experiments
