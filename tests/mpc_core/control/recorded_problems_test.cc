#include "tests/mpc_core/control/recorded_problems.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

/// The solver finds the recorded optima again, whatever was done to it for speed.
namespace stilt::testing_support {
namespace {

constexpr const char* kFile = STILT_TEST_DATA "/recorded_problems.txt";
constexpr double kSame = 1e-8;

/// Blocks of problems, so that a slow machine can take one of them.
constexpr std::size_t kBlocks = 10;

class RecordedProblems : public ::testing::Test {
 protected:
  static const std::vector<RecordedProblem>& problems() {
    static const std::vector<RecordedProblem> kProblems = read_problems(kFile);
    return kProblems;
  }

  const std::unique_ptr<sqp::Sqp> sqp_ = std::make_unique<sqp::Sqp>();
};

TEST_F(RecordedProblems, AreManyAndVaried) {
  int robots[2] = {};
  int gaits[3] = {};
  double shortest_s = INFINITY;
  double longest_s = 0.0;
  for (const RecordedProblem& problem : problems()) {
    ++robots[problem.question.robot == "rabbit"];
    ++gaits[static_cast<int>(problem.question.command.kind)];
    shortest_s = std::min(shortest_s, problem.question.horizon_s);
    longest_s = std::max(longest_s, problem.question.horizon_s);
  }
  EXPECT_GE(problems().size(), 200U);
  for (const int count : robots) EXPECT_GE(count, 20);
  for (const int count : gaits) EXPECT_GE(count, 20);
  EXPECT_EQ(shortest_s, 0.2);
  EXPECT_EQ(longest_s, 2.0);
}

class RecordedBlock : public RecordedProblems, public ::testing::WithParamInterface<std::size_t> {};

TEST_P(RecordedBlock, HasTheSameOptimaAsWhenItWasRecorded) {
  double worst_cost = 0.0;
  double worst_trajectory = 0.0;
  for (std::size_t i = GetParam(); i < problems().size(); i += kBlocks) {
    const RecordedProblem& recorded = problems()[i];
    const auto prepared = prepare(recorded.question);
    ASSERT_EQ(prepared->problem.horizon.stages, recorded.optimum.stages) << "problem " << i;
    const auto iterate = std::make_unique<ocp::Trajectory>(prepared->guess);
    const HardSolve solve = solve_hard(*prepared, *sqp_, *iterate);
    ASSERT_TRUE(solve.usable) << "problem " << i;
    const double cost_change =
        std::abs(solve.cost - recorded.optimum.cost) / std::max(1.0, std::abs(recorded.optimum.cost));
    const double trajectory_change = distance(sampled(*prepared, *iterate, solve.cost), recorded.optimum);
    EXPECT_LE(cost_change, kSame) << "problem " << i;
    EXPECT_LE(trajectory_change, kSame) << "problem " << i;
    EXPECT_LE(solve.violation, 1e-7) << "problem " << i;
    worst_cost = std::max(worst_cost, cost_change);
    worst_trajectory = std::max(worst_trajectory, trajectory_change);
  }
  std::printf("largest difference: cost %.1e, trajectory %.1e\n", worst_cost, worst_trajectory);
}

INSTANTIATE_TEST_SUITE_P(Problems, RecordedBlock, ::testing::Range<std::size_t>(0, kBlocks));

TEST_F(RecordedProblems, ADifferentWeightMovesTheOptimumNoticeably) {
  const RecordedProblem& recorded = problems().front();
  const auto prepared = prepare(recorded.question);
  prepared->data.state_weight[1] *= 1.0 + 1e-5;
  const auto iterate = std::make_unique<ocp::Trajectory>(prepared->guess);
  const HardSolve solve = solve_hard(*prepared, *sqp_, *iterate);
  ASSERT_TRUE(solve.usable);
  EXPECT_GT(distance(sampled(*prepared, *iterate, solve.cost), recorded.optimum), kSame);
}

}  // namespace
}  // namespace stilt::testing_support
