#include "host_tools/experiments/push_limit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace stilt::experiments {
namespace {

/// A robot that falls under these forces, N, and keeps a list of what was tried.
struct Robot {
  std::function<bool(double)> falls;
  std::set<double> tried = {};

  PushTrial push(double force_N) {
    tried.insert(force_N);
    PushTrial trial;
    trial.force_N = force_N;
    trial.survived = !falls(force_N);
    return trial;
  }
};

PushLimit limit_of(Robot& robot, const PushSearch& search = {}) {
  return find_push_limit(search, [&](double force_N) { return robot.push(force_N); });
}

TEST(PushLimit, IsFoundToOneNewton) {
  for (int first_failure_N = 1; first_failure_N <= 60; ++first_failure_N) {
    Robot robot{[&](double force_N) { return force_N >= first_failure_N; }};
    EXPECT_EQ(limit_of(robot).force_N, first_failure_N - 1.0);
  }
}

TEST(PushLimit, OfARobotThatFallsUnpushedIsNone) {
  Robot robot{[](double) { return true; }};
  EXPECT_FALSE(limit_of(robot).force_N.has_value());
  EXPECT_EQ(robot.tried, std::set<double>{0.0});
}

TEST(PushLimit, DoesNotSkipAnIslandOfFalls) {
  Robot robot{[](double force_N) { return force_N >= 29.5 && force_N <= 30.5; }};
  EXPECT_EQ(limit_of(robot).force_N, 29.0) << "larger pushes are survived again, but 30 N is not";
}

TEST(PushLimit, TriesEveryCoarseForceBelowTheLimit) {
  Robot robot{[](double force_N) { return force_N > 47.0; }};
  EXPECT_EQ(limit_of(robot, {5.0, 1.0, 300.0}).force_N, 47.0);
  for (double force_N = 0.0; force_N <= 50.0; force_N += 5.0) EXPECT_TRUE(robot.tried.contains(force_N));
}

TEST(PushLimit, StopsAtTheLargestForce) {
  Robot robot{[](double) { return false; }};
  EXPECT_EQ(limit_of(robot, {10.0, 1.0, 35.0}).force_N, 30.0);
}

TEST(PushLimit, OfForcesThatAreNoBinaryFractionsStopsAtTheLargestToo) {
  Robot robot{[](double) { return false; }};
  EXPECT_EQ(limit_of(robot, {0.1, 0.1, 0.3}).force_N, 3 * 0.1) << "0.3 / 0.1 is a little less than 3";
  EXPECT_EQ(robot.tried.size(), 4u);
}

TEST(PushLimit, WasSurvivedAndTheNextNewtonWasNot) {
  constexpr std::uint32_t kSeed = 7;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (int round = 0; round < 200; ++round) {
    std::set<int> falls;
    for (int i = 0; i < 4; ++i) falls.insert(static_cast<int>(random() % 80) + 1);
    Robot robot{[&](double force_N) { return falls.contains(static_cast<int>(force_N)) || force_N > 90.0; }};
    const PushLimit limit = limit_of(robot);
    ASSERT_TRUE(limit.force_N.has_value());
    EXPECT_FALSE(robot.falls(*limit.force_N)) << "round " << round;
    EXPECT_TRUE(robot.falls(*limit.force_N + 1.0)) << "round " << round;
    EXPECT_EQ(limit.trials.size(), robot.tried.size()) << "nothing is tried twice";
  }
}

}  // namespace
}  // namespace stilt::experiments
