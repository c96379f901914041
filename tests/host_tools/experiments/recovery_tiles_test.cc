#include "host_tools/experiments/recovery_tiles.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stilt::experiments {
namespace {

/// Touch-downs every 0.3 s from 0.3 s on; the step that lands at the n-th is 0.1 n long.
log::RunRecord walk(int touch_downs) {
  log::RunRecord record;
  for (int n = 1; n <= touch_downs; ++n) {
    record.summary.steps.push_back({0.3 * n, std::string(1, n % 2 == 0 ? 'L' : 'R'), 0.1 * n});
  }
  record.summary.survived = true;
  for (double time_s = 0.0; time_s < 0.3 * touch_downs + 0.1; time_s += 0.005) {
    log::RunSample& sample = record.samples.emplace_back();
    sample.time_s = time_s;
    sample.true_state.setZero();
  }
  return record;
}

std::vector<double> lengths_m(const log::RunRecord& record, const PushedWalk& push) {
  const Json json = recovery_json(record, push);
  std::vector<double> lengths_m;
  for (const Json& step : json.at("steps")) lengths_m.push_back(step.at("length_m"));
  return lengths_m;
}

TEST(RecoveryTiles, GoFromTheLastTouchDownBeforeThePushToTheRecovery) {
  // Landed before the push: 0.3, 0.6; while it acts: 0.9, 1.2, 1.5; recovered with the second after it: 2.1.
  const PushedWalk push{20.0, 0.7, 1.7, 2};
  const std::vector<double> shown = lengths_m(walk(12), push);
  ASSERT_EQ(shown.size(), 6u);
  EXPECT_NEAR(shown.front(), 0.2, 1e-12);
  EXPECT_NEAR(shown.back(), 0.7, 1e-12);
}

TEST(RecoveryTiles, WithoutARecoveryGoToTheEndOrToSixteen) {
  EXPECT_EQ(lengths_m(walk(9), {20.0, 0.7, 1.7, std::nullopt}).size(), 8u);
  EXPECT_EQ(lengths_m(walk(40), {20.0, 0.7, 1.7, std::nullopt}).size(), 16u);
  EXPECT_TRUE(lengths_m(walk(0), {20.0, 0.7, 1.7, std::nullopt}).empty());
}

TEST(RecoveryTiles, MarkTheTouchDownsUnderThePush) {
  const log::RunRecord record = walk(12);
  const PushedWalk push{20.0, 0.7, 1.7, 2};
  std::vector<bool> pushed;
  const Json recovery = recovery_json(record, push);
  for (const Json& step : recovery.at("steps")) pushed.push_back(step.at("pushed"));
  EXPECT_EQ(pushed, (std::vector<bool>{false, true, true, true, false, false}));
  int red = 0;
  for (const plot::Label& label : recovery_tiles(record, push, "").labels)
    red += label.colour == "var(--bad)";
  EXPECT_EQ(red, 2 * 3) << "a time and a length each";
}

TEST(RecoveryTiles, StandApartWithTheLengthOfTheStepBelow) {
  const plot::Plot figure = recovery_tiles(walk(12), {20.0, 0.7, 1.7, 2}, "A push");
  ASSERT_EQ(figure.labels.size(), 12u);
  EXPECT_EQ(figure.labels[0].words, "-0.10 s");
  EXPECT_EQ(figure.labels[1].words, "0.20 m");
  EXPECT_LT(figure.labels[1].y, 0.0) << "below the ground";
  for (std::size_t i = 2; i < figure.labels.size(); i += 2) {
    EXPECT_GT(figure.labels[i].x, figure.labels[i - 2].x + 0.9);
  }
  const std::string svg = plot::svg(figure);
  EXPECT_NE(svg.find(">0.70 m</text>"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace stilt::experiments
