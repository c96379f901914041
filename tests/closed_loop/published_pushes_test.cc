#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_tools/cli/disturbance_experiment.h"
#include "tests/closed_loop/published_results.h"

/// Guards of the published pushes: of each row of docs/results the two worst cases survive 85 % of the
/// published force, and the robot walks without a push at the published speed.
namespace stilt::experiments {
namespace {

using testing_support::kGuardedShare;
using testing_support::kSameSpeed_m_s;
using testing_support::results_of;

constexpr const char* kTables[] = {"pushes",  "directions", "motors",   "changes", "paper",
                                   "realism", "rabbit",     "terminal", "tuning",  "rates"};

struct PublishedRow {
  std::string table;
  Json figures;

  friend std::ostream& operator<<(std::ostream& stream, const PublishedRow& row) {
    return stream << row.table << " " << row.figures.at("name");
  }
};

/// The rows with a push, of every table of pushes.
std::vector<PublishedRow> published_rows_with_a_push() {
  std::vector<PublishedRow> rows;
  for (const char* table : kTables) {
    const Json results = results_of(table);
    for (const Json& row : results.at("rows")) {
      if (!row.at("push_all_phases_N").is_null()) rows.push_back({table, row});
    }
  }
  return rows;
}

TEST(PublishedTables, HaveResults) {
  for (const char* table : kTables) EXPECT_FALSE(results_of(table).at("rows").empty()) << table;
}

class PublishedPushes : public ::testing::TestWithParam<PublishedRow> {
 protected:
  PublishedPushes() : plan_(cli::plan_of_rows(STILT_RESULTS "/" + GetParam().table + ".toml")) {
    const auto named =
        std::ranges::find(plan_.rows, GetParam().figures.at("name").get<std::string>(), &PushRow::name);
    if (named == plan_.rows.end()) throw std::runtime_error("the table has no such row any more");
    row_ = *named;
    row_.phases = GetParam().figures.at("phases").get<int>();
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

INSTANTIATE_TEST_SUITE_P(ClosedLoop, PublishedPushes, ::testing::ValuesIn(published_rows_with_a_push()),
                         [](const auto& test) {
                           return testing_support::test_name(
                               test.param.table + "_" +
                               test.param.figures.at("name").template get<std::string>());
                         });

}  // namespace
}  // namespace stilt::experiments
