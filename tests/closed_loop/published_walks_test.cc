#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "host_tools/cli/experiment_walks.h"
#include "host_tools/cli/limits_experiment.h"
#include "host_tools/cli/speeds_experiment.h"
#include "host_tools/experiments/blind_limits.h"
#include "host_tools/experiments/commanded_speeds.h"
#include "host_tools/experiments/shortest_horizon.h"
#include "host_tools/experiments/walks.h"
#include "tests/closed_loop/published_plan.h"
#include "tests/closed_loop/published_results.h"

/// Guards of the published limits, sequences of commands, shortest horizons and speeds (docs/results).
namespace stilt::experiments {
namespace {

using testing_support::kGuardedShare;
using testing_support::kSameSpeed_m_s;
using testing_support::results_of;

/// A row of a table, and the file's settings.
struct Published {
  std::string name;
  Json figures;
  Json settings;

  friend std::ostream& operator<<(std::ostream& stream, const Published& row) { return stream << row.name; }
};

/// Of what is survived unannounced.
constexpr const char* kLimitTables[] = {"limits",        "limits_seeds",        "limits_steps",
                                        "limits_motors", "limits_motors_seeds", "limits_steps_motors"};
constexpr const char* kHorizonTables[] = {"horizons", "horizons_motors"};
constexpr const char* kSpeedTables[] = {"speeds", "speeds_motors"};

cli::WalkSetting setting_of(const Json& settings) {
  cli::WalkSetting setting;
  setting.choice.settings = settings.at("set").get<std::vector<std::string>>();
  setting.plant_settings = settings.at("plant").get<std::vector<std::string>>();
  return setting;
}

WalkRunner runner_of(const Json& settings) { return cli::runner_for_each(setting_of(settings)); }

LimitPlan::Controller controller_of(const Published& published) {
  const std::string name = published.figures.at("controller").get<std::string>();
  const double horizon_s = published.figures.at("horizon_s").get<double>();
  const cli::WalkSetting setting = cli::setting_for(setting_of(published.settings), name);
  return {name, horizon_s, cli::walk_step_time_s(setting, name, horizon_s)};
}

std::string test_name(const ::testing::TestParamInfo<Published>& test) {
  return testing_support::test_name(test.param.name);
}

TEST(PublishedTables, HaveResults) {
  for (const char* table : kLimitTables) EXPECT_FALSE(results_of(table).at("rows").empty()) << table;
  for (const char* table : kHorizonTables) EXPECT_FALSE(results_of(table).at("rows").empty()) << table;
  for (const char* table : kSpeedTables) EXPECT_FALSE(results_of(table).at("rows").empty()) << table;
}

/// What is guarded is what was measured, in the limits and in the sequences.
TEST(PublishedTables, HaveTheConditionsOfTheLimits) {
  for (const char* table : kLimitTables) {
    SCOPED_TRACE(table);
    const LimitPlan today = cli::limit_plan(testing_support::published_options(table));
    const auto jobs = limit_jobs(today, testing_support::no_walk);
    const Json merged = merge_limits(today, testing_support::results_without_walks(jobs));
    const Json published = results_of(table);
    testing_support::expect_each_published(
        merged.at("rows"), published.at("rows"),
        {"controller", "horizon_s", "duration_s", "speed_m_s", "name", "quantity", "unit", "direction",
         "nominal", "phases", "cases", "coarse", "fine", "last_tried"});
    const Json& sequences = merged.at("sequences");
    testing_support::expect_each_published(sequences, published.at("sequences"),
                                           {"controller", "horizon_s", "of", "duration_s"});
    for (std::size_t i = 0; i < sequences.size(); ++i) {
      testing_support::expect_each_published(
          sequences[i].at("runs"), published.at("sequences").at(i).at("runs"), {"seed", "commands"});
    }
  }
}

TEST(PublishedTables, HaveTheConditionsOfTheHorizons) {
  for (const char* table : kHorizonTables) {
    SCOPED_TRACE(table);
    const HorizonPlan today = cli::horizon_plan(testing_support::published_options(table));
    const auto jobs = horizon_jobs(today, testing_support::no_walk);
    const Json merged = merge_horizons(today, testing_support::results_without_walks(jobs));
    const Json published = results_of(table);
    testing_support::expect_each_published(merged.at("rows"), published.at("rows"),
                                           {"controller", "commanded_speed_m_s", "duration_s", "seeds"});
    for (std::size_t i = 0; i < published.at("rows").size(); ++i) {
      testing_support::expect_each_published(merged.at("rows").at(i).at("tried"),
                                             published.at("rows").at(i).at("tried"), {"horizon_s"});
    }
  }
}

TEST(PublishedTables, HaveTheConditionsOfTheSpeeds) {
  for (const char* table : kSpeedTables) {
    SCOPED_TRACE(table);
    const SpeedPlan today = cli::speed_plan(testing_support::published_options(table));
    const auto jobs = speed_jobs(today, testing_support::no_walk);
    const Json merged = merge_speeds(testing_support::results_without_walks(jobs));
    testing_support::expect_each_published(merged.at("rows"), results_of(table).at("rows"),
                                           {"controller", "horizon_s", "duration_s", "speed_m_s"});
  }
}

std::vector<Published> published_limits() {
  std::vector<Published> rows;
  for (const char* table : kLimitTables) {
    const Json json = results_of(table);
    for (const Json& row : json.at("rows")) {
      if (row.at("limit_all").is_null()) continue;
      rows.push_back(
          {std::string(table) + "_" + row.at("name").get<std::string>(), row, json.at("settings")});
    }
  }
  return rows;
}

class PublishedLimits : public ::testing::TestWithParam<Published> {};

TEST_P(PublishedLimits, TheTwoWorstCasesPassAt85PercentOfTheMargin) {
  const Json& figures = GetParam().figures;
  const std::vector<BlindQuantity>& quantities = blind_quantities();
  const auto quantity =
      std::ranges::find(quantities, figures.at("name").get<std::string>(), &BlindQuantity::name);
  ASSERT_NE(quantity, quantities.end());
  LimitPlan plan;
  plan.phases = figures.at("phases").get<int>();
  const double margin = figures.at("limit_all").get<double>() - quantity->nominal;
  const double value = quantity->nominal + kGuardedShare * margin;
  const WalkRunner run = runner_of(GetParam().settings);
  for (const Json& worst : figures.at("worst_cases")) {
    const WalkCase walk = limit_case(plan, controller_of(GetParam()), *quantity, worst.at("phase").get<int>(),
                                     worst.at("seed").get<int>(), value);
    const log::RunSummary summary = run(walk).summary;
    EXPECT_TRUE(quantity->passes(walk, summary))
        << value << " " << quantity->unit << ", " << worst << ": "
        << (summary.survived ? "survives" : "falls") << ", mean speed " << summary.mean_speed_m_s << " m/s";
  }
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, PublishedLimits, ::testing::ValuesIn(published_limits()), test_name);

/// Seen from outside, with the sensors' noise. Up, four phases are too few: some positions between them fail.
TEST(BlindLimits, GroundStepsOf4CentimetresUpPassAt32PhasesAnd20DownAtFour) {
  const Json limits = results_of("limits");
  const Published up{"up", limits.at("rows").at(0), limits.at("settings")};
  const WalkRunner run = runner_of(up.settings);
  for (const auto& [name, height_m, phases] :
       {std::tuple{"step_up", 0.04, 32}, std::tuple{"step_down", -0.2, 4}}) {
    LimitPlan plan;
    plan.phases = phases;
    const auto quantity = std::ranges::find(blind_quantities(), name, &BlindQuantity::name);
    ASSERT_NE(quantity, blind_quantities().end());
    for (int phase = 0; phase < plan.phases; ++phase) {
      const WalkCase walk = limit_case(plan, controller_of(up), *quantity, phase, 1, height_m);
      EXPECT_TRUE(quantity->passes(walk, run(walk).summary)) << height_m << " m at phase " << phase;
    }
  }
}

std::vector<Published> published_sequences() {
  std::vector<Published> rows;
  for (const std::string table : {"limits", "limits_motors"}) {
    const Json json = results_of(table);
    for (const Json& sequence : json.at("sequences")) {
      for (const Json& run : sequence.at("runs")) {
        if (!run.at("survived").get<bool>()) continue;
        Json figures = run;
        figures["controller"] = sequence.at("controller");
        figures["horizon_s"] = sequence.at("horizon_s");
        rows.push_back({table + "_sequence_" + run.at("seed").dump(), figures, json.at("settings")});
      }
    }
  }
  return rows;
}

class PublishedSequences : public ::testing::TestWithParam<Published> {};

TEST_P(PublishedSequences, AMinuteOfRandomCommandsIsWalked) {
  const Json& figures = GetParam().figures;
  const WalkCase walk = sequence_case({}, controller_of(GetParam()), figures.at("seed").get<int>());
  const log::RunSummary summary = runner_of(GetParam().settings)(walk).summary;
  EXPECT_TRUE(summary.survived) << "falls at " << summary.fall_time_s << " s";
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, PublishedSequences, ::testing::ValuesIn(published_sequences()),
                         test_name);

std::vector<Published> published_horizons() {
  std::vector<Published> rows;
  for (const std::string table : kHorizonTables) {
    const Json json = results_of(table);
    for (const Json& row : json.at("rows")) {
      Json shorter_s = nullptr;
      for (const Json& tried : row.at("tried")) {
        const Json next_shorter_s = std::exchange(shorter_s, tried.at("horizon_s"));
        if (row.at("shortest_horizon_s") != tried.at("horizon_s")) continue;
        Json figures = tried;
        figures["next_shorter_s"] = next_shorter_s;
        for (const char* field : {"duration_s", "commanded_speed_m_s", "controller"}) {
          figures[field] = row.at(field);
        }
        rows.push_back({table + "_" + row.at("controller").get<std::string>(), figures, json.at("settings")});
      }
    }
  }
  return rows;
}

class PublishedHorizons : public ::testing::TestWithParam<Published> {};

TEST_P(PublishedHorizons, WalkAMinuteAtTheCommandedSpeedAndTheNextShorterDoesNot) {
  const Json& figures = GetParam().figures;
  WalkCase walk;
  walk.controller = figures.at("controller").get<std::string>();
  walk.horizon_s = figures.at("horizon_s").get<double>();
  walk.duration_s = figures.at("duration_s").get<double>();
  walk.command.speed_m_s = figures.at("commanded_speed_m_s").get<double>();
  const log::RunSummary summary = runner_of(GetParam().settings)(walk).summary;
  EXPECT_TRUE(walks(walk.command, summary)) << summary.mean_speed_m_s << " m/s";
  EXPECT_NEAR(summary.mean_speed_m_s, figures.at("mean_speed_m_s").get<double>(), kSameSpeed_m_s);
  if (figures.at("next_shorter_s").is_null()) return;
  walk.horizon_s = figures.at("next_shorter_s").get<double>();
  const log::RunSummary shorter = runner_of(GetParam().settings)(walk).summary;
  EXPECT_FALSE(walks(walk.command, shorter)) << walk.horizon_s << " s, measure the row anew";
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, PublishedHorizons, ::testing::ValuesIn(published_horizons()), test_name);

std::vector<Published> published_speeds() {
  std::vector<Published> rows;
  for (const std::string table : kSpeedTables) {
    const Json json = results_of(table);
    for (const Json& row : json.at("rows")) {
      rows.push_back({table + "_" + row.at("speed_m_s").dump(), row, json.at("settings")});
    }
  }
  return rows;
}

class PublishedSpeeds : public ::testing::TestWithParam<Published> {};

TEST_P(PublishedSpeeds, AreWalkedForAMinuteWithoutAnAllocation) {
  const Json& figures = GetParam().figures;
  SpeedPlan plan;
  plan.speeds_m_s = {figures.at("speed_m_s").get<double>()};
  const Json row = speed_jobs(plan, runner_of(GetParam().settings)).front().run();
  EXPECT_TRUE(row.at("walks").get<bool>()) << row;
  EXPECT_NEAR(row.at("mean_speed_m_s").get<double>(), figures.at("mean_speed_m_s").get<double>(),
              kSameSpeed_m_s);
  EXPECT_EQ(row.at("heap_allocations_in_loop"), figures.at("heap_allocations_in_loop"));
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, PublishedSpeeds, ::testing::ValuesIn(published_speeds()), test_name);

}  // namespace
}  // namespace stilt::experiments
