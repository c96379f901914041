#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_tools/cli/disturbance_experiment.h"
#include "host_tools/experiments/push_row.h"
#include "tests/closed_loop/published_plan.h"
#include "tests/closed_loop/published_results.h"

/// Guards of the published pushes. Of each row of docs/results the two worst cases survive 85 % of the
/// published force. The robot walks without a push at the published speed.
namespace stilt::experiments {
namespace {

using testing_support::kGuardedShare;
using testing_support::kSameSpeed_m_s;
using testing_support::results_of;

constexpr const char* kTables[] = {"pushes", "pushes_short", "directions", "motors", "motors_short", "rates",
                                   "paper", "changes", "realism", "rabbit", "terminal", "tuning",
                                   // with weaker motors
                                   "rates_motors", "paper_motors", "changes_motors", "rabbit_motors",
                                   "terminal_motors", "tuning_motors"};

/// The experiment of the command that made a table.
DisturbancePlan plan_of(const std::string& table) {
  cli::ExperimentOptions options = testing_support::published_options(table);
  options.rows_file = STILT_RESULTS "/" + std::filesystem::path(options.rows_file).filename().string();
  return cli::disturbance_plan(options);
}

struct PublishedRow {
  std::string table;
  Json figures;

  friend std::ostream& operator<<(std::ostream& stream, const PublishedRow& row) {
    return stream << row.table << " " << row.figures.at("name");
  }
};

/// The rows of every table of pushes, with a push or those that fall without one.
std::vector<PublishedRow> published_rows(bool with_a_push) {
  std::vector<PublishedRow> rows;
  for (const char* table : kTables) {
    const Json results = results_of(table);
    for (const Json& row : results.at("rows")) {
      if (!row.at("push_all_phases_N").is_null() == with_a_push) rows.push_back({table, row});
    }
  }
  return rows;
}

TEST(PublishedTables, HaveResults) {
  for (const char* table : kTables) EXPECT_FALSE(results_of(table).at("rows").empty()) << table;
}

/// What is guarded is what was measured: today's rows and defaults are those of the results.
TEST(PublishedTables, HaveTheConditionsOfTheirRows) {
  for (const char* table : kTables) {
    const DisturbancePlan plan = plan_of(table);
    const Json results = results_of(table);
    ASSERT_EQ(results.at("rows").size(), plan.rows.size()) << table;
    for (std::size_t i = 0; i < plan.rows.size(); ++i) {
      const Json& published = results.at("rows")[i];
      const PushRow& row = plan.rows[i];
      const Json conditions = described(plan, row);
      for (const auto& [field, value] : conditions.items()) {
        EXPECT_EQ(published.at(field), value) << table << ", " << row.name << ": " << field;
      }
    }
  }
}

class PublishedPushes : public ::testing::TestWithParam<PublishedRow> {
 protected:
  PublishedPushes() : plan_(plan_of(GetParam().table)) {
    const auto named =
        std::ranges::find(plan_.rows, GetParam().figures.at("name").get<std::string>(), &PushRow::name);
    if (named == plan_.rows.end()) throw std::runtime_error("the table has no such row any more");
    row_ = *named;
  }

  DisturbancePlan plan_;
  PushRow row_;
};

TEST_P(PublishedPushes, TheTwoWorstCasesSurvive85PercentAndTheSpeedIsTheOnePublished) {
  const Json& figures = GetParam().figures;
  const double force_N = kGuardedShare * figures.at("push_all_phases_N").get<double>();
  ASSERT_FALSE(figures.at("worst_cases").empty());
  for (const Json& worst : figures.at("worst_cases")) {
    const int phase = worst.at("phase").get<int>();
    const int seed = worst.at("seed").get<int>();
    const PushTrial pushed = push_case(plan_, row_, phase, seed, force_N);
    EXPECT_TRUE(pushed.survived) << force_N << " N at phase " << phase << ", seed " << seed << ": falls at "
                                 << pushed.fall_time_s << " s";
  }
  const Json& worst = figures.at("worst_cases")[0];
  const PushTrial unpushed =
      push_case(plan_, row_, worst.at("phase").get<int>(), worst.at("seed").get<int>(), 0.0);
  EXPECT_TRUE(unpushed.survived);
  EXPECT_NEAR(unpushed.mean_speed_m_s, figures.at("unpushed_speed_m_s").get<double>(), kSameSpeed_m_s);
  if (figures.at("walks").get<bool>()) {
    EXPECT_TRUE(unpushed.walks) << unpushed.mean_speed_m_s << " m/s";
  }
}

using PublishedFalls = PublishedPushes;

TEST_P(PublishedFalls, ARowThatFallsUnpushedDoes) {
  const Json& worst = GetParam().figures.at("worst_cases")[0];
  const PushTrial unpushed =
      push_case(plan_, row_, worst.at("phase").get<int>(), worst.at("seed").get<int>(), 0.0);
  EXPECT_FALSE(unpushed.survived) << "measure the row anew";
}

std::string name_of(const ::testing::TestParamInfo<PublishedRow>& test) {
  return testing_support::test_name(test.param.table + "_" +
                                    test.param.figures.at("name").get<std::string>());
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, PublishedPushes, ::testing::ValuesIn(published_rows(true)), name_of);
INSTANTIATE_TEST_SUITE_P(ClosedLoop, PublishedFalls, ::testing::ValuesIn(published_rows(false)), name_of);

}  // namespace
}  // namespace stilt::experiments
