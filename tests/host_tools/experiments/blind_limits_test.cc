#include "host_tools/experiments/blind_limits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "host_tools/simulation/plant/plant_options.h"

namespace stilt::experiments {
namespace {

using simulation::PlantOptions;

PlantOptions world_of(const WalkCase& walk) {
  PlantOptions world;
  for (const std::string& assignment : walk.plant) simulation::set_plant_option(world, assignment);
  return world;
}

log::RunRecord record(bool survived, double distance_m = 10.0, double mean_speed_m_s = 0.5) {
  log::RunRecord record;
  record.summary.survived = survived;
  record.summary.fall_time_s = survived ? -1.0 : 3.0;
  record.summary.distance_m = distance_m;
  record.summary.mean_speed_m_s = mean_speed_m_s;
  return record;
}

LimitPlan plan_of(const std::string& quantity, int phases = 1, int seeds = 1) {
  LimitPlan plan;
  plan.phases = phases;
  plan.seeds = seeds;
  plan.sequences = 0;
  std::erase_if(plan.quantities, [&](const BlindQuantity& one) { return one.name != quantity; });
  EXPECT_EQ(plan.quantities.size(), 1u) << quantity;
  return plan;
}

Json merged(const LimitPlan& plan, const WalkRunner& run) {
  std::vector<Json> results;
  for (const Job& job : limit_jobs(plan, run)) results.push_back(job.run());
  return merge_limits(plan, results);
}

Json row_of(const LimitPlan& plan, const WalkRunner& run) { return merged(plan, run).at("rows").at(0); }

TEST(BlindLimits, AreFoundInTheQuantitysOwnDirectionAndUnit) {
  const Json friction = row_of(plan_of("friction"),
                               [](const WalkCase& walk) { return record(world_of(walk).friction > 0.27); });
  EXPECT_EQ(friction.at("limit_all"), 0.28);
  EXPECT_EQ(friction.at("falls"), 1);
  const Json up = row_of(plan_of("slope_up"), [](const WalkCase& walk) {
    return record(world_of(walk).ground_slope_rad < 0.125);
  });
  EXPECT_EQ(up.at("limit_all"), 0.12);
  const Json down = row_of(plan_of("slope_down"), [](const WalkCase& walk) {
    return record(world_of(walk).ground_slope_rad > -0.205);
  });
  EXPECT_EQ(down.at("limit_all"), -0.2);
  const Json delay = row_of(plan_of("plan_delay"), [](const WalkCase& walk) {
    return record(walk.settings.at(0).compare("timing.plan_delay_s=0.03") <= 0);
  });
  EXPECT_EQ(delay.at("limit_all"), 0.03);
}

TEST(BlindLimits, AreThoseOfTheWorstCaseAndOfHalfOfThem) {
  const Json row = row_of(plan_of("mass_up", 1, 3), [](const WalkCase& walk) {
    return record(world_of(walk).mass_scale < 1.15 + 0.1 * static_cast<double>(walk.seed));
  });
  EXPECT_EQ(row.at("cases"), 3);
  EXPECT_EQ(row.at("limits"), Json({1.24, 1.34, 1.44}));
  EXPECT_EQ(row.at("limit_all"), 1.24);
  EXPECT_EQ(row.at("limit_half"), 1.34);
}

TEST(BlindLimits, OfACaseThatGoesDownTheWorstIsTheOneNearestToTheNominalWorld) {
  const Json row = row_of(plan_of("mass_down", 1, 3), [](const WalkCase& walk) {
    return record(world_of(walk).mass_scale > 0.85 - 0.1 * static_cast<double>(walk.seed));
  });
  EXPECT_EQ(row.at("limits"), Json({0.76, 0.66, 0.56}));
  EXPECT_EQ(row.at("worst_cases")[0].at("seed"), 1);
}

TEST(BlindLimits, AQuantityWithoutAPlaceHasOneCasePerSeed) {
  const Json row = row_of(plan_of("friction", 8, 2), [](const WalkCase&) { return record(true); });
  EXPECT_EQ(row.at("cases"), 2);
  EXPECT_EQ(row.at("phases"), 1);
}

TEST(BlindLimits, TheSpeedIsThatOfTheTrialsAtTheLimit) {
  const Json row = row_of(plan_of("mass_up", 1, 2), [](const WalkCase& walk) {
    const double scale = world_of(walk).mass_scale;
    return record(scale < 1.15 + 0.1 * static_cast<double>(walk.seed), 10.0, 1.0 - 0.5 * scale);
  });
  EXPECT_NEAR(row.at("speed_max_m_s").get<double>(), 1.0 - 0.5 * 1.24, 1e-12);
  EXPECT_NEAR(row.at("speed_min_m_s").get<double>(), 1.0 - 0.5 * 1.34, 1e-12);
}

TEST(BlindLimits, ARobotThatFallsInTheNominalWorldHasNone) {
  const Json row = row_of(plan_of("friction"), [](const WalkCase&) { return record(false); });
  EXPECT_TRUE(row.at("limit_all").is_null());
  EXPECT_TRUE(row.at("speed_min_m_s").is_null());
}

TEST(BlindLimits, WithoutAFallTheLimitIsTheLastValueTried) {
  const Json row = row_of(plan_of("friction"), [](const WalkCase&) { return record(true); });
  EXPECT_EQ(row.at("falls"), 0);
  EXPECT_EQ(row.at("limit_all"), 0.1);
  EXPECT_EQ(row.at("last_tried"), 0.1);
}

TEST(BlindLimits, AStepIsMetAtEveryPhaseOfBothFeet) {
  std::set<double> positions_m;
  LimitPlan plan = plan_of("step_down", 8, 1);
  (void)merged(plan, [&](const WalkCase& walk) {
    positions_m.insert(world_of(walk).step_position_m);
    return record(false);
  });
  ASSERT_EQ(positions_m.size(), 8u);
  EXPECT_EQ(*positions_m.begin(), 2.0);
  EXPECT_NEAR(*positions_m.rbegin(), 2.0 + 0.15 * (1.0 + 7.0 / 8.0), 1e-5);
}

TEST(BlindLimits, ARobotThatStopsAtAStepHasNotPassedIt) {
  const Json row = row_of(plan_of("step_up"), [](const WalkCase& walk) {
    return record(true, world_of(walk).step_height_m > 0.05 ? 1.9 : 9.0);
  });
  EXPECT_EQ(row.at("limit_all"), 0.05);
}

TEST(BlindLimits, ASpeedCountsWhenTheRobotWalksAtIt) {
  const auto slower_above_one = [](const WalkCase& walk) {
    return record(true, 10.0, std::clamp(walk.command.speed_m_s, -0.3, 1.0));
  };
  EXPECT_EQ(row_of(plan_of("speed_forward"), slower_above_one).at("limit_all"), 1.1);
  EXPECT_EQ(row_of(plan_of("speed_backward"), slower_above_one).at("limit_all"), -0.3);
}

TEST(BlindLimits, SequencesOfCommandsAreCounted) {
  LimitPlan plan;
  plan.quantities.clear();
  const Json json = merged(plan, [](const WalkCase& walk) {
    EXPECT_EQ(walk.duration_s, 60.0);
    EXPECT_GE(walk.later_commands.size(), 7u);
    EXPECT_GT(walk.later_commands.front().start_s, 0.0) << "the first command is the walk's own";
    return record(walk.seed != 4);
  });
  ASSERT_EQ(json.at("sequences").size(), 1u);
  EXPECT_EQ(json.at("sequences")[0].at("survived"), 9);
  EXPECT_EQ(json.at("sequences")[0].at("of"), 10);
  EXPECT_EQ(json.at("sequences")[0].at("runs")[3].at("fall_time_s"), 3.0);
}

TEST(BlindLimits, EveryControllerHasItsOwnRows) {
  LimitPlan plan = plan_of("friction");
  plan.controllers = {{"mpc-heuristic", 1.0, 0.3}, {"mpc-hzd", 0.5, 0.3}};
  const Json rows = merged(plan, [](const WalkCase& walk) {
                      return record(world_of(walk).friction > (walk.controller == "mpc-hzd" ? 0.5 : 0.3));
                    }).at("rows");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("limit_all"), 0.32);
  EXPECT_EQ(rows[1].at("limit_all"), 0.52);
  EXPECT_EQ(rows[1].at("horizon_s"), 0.5);
}

TEST(BlindLimits, EveryQuantityStaysWithinTheRangesOfThePlant) {
  for (const BlindQuantity& quantity : blind_quantities()) {
    WalkCase walk;
    quantity.apply(quantity.nominal + quantity.search.largest, 0.0, walk);
    EXPECT_NO_THROW((void)world_of(walk)) << quantity.name;
    const double steps = quantity.search.coarse / quantity.search.fine;
    EXPECT_NEAR(steps, std::round(steps), 1e-9) << quantity.name << ": fine divides coarse";
  }
}

}  // namespace
}  // namespace stilt::experiments
