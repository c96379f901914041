// Where a solve starts from: what the planner does before it solves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/mpc_core/control/planning.h"
#include "tests/robots.h"

namespace stilt::control {
namespace {

using model::kInputs;
using model::kPositions;
using model::StateVector;
using testing_support::kWalk;
using testing_support::Planning;
using testing_support::shipped;

/// From now on a solve ends before its first iteration: its plan is its initial guess.
void guess_only(Planning& planning) {
  ControllerParameters parameters = testing_support::with_every_plan(planning.parameters);
  parameters.sqp.iterations = 0;
  const auto settings = std::make_unique<PlannerSettings>();
  const auto work = std::make_unique<sqp::TerminalCostWorkspace>();
  ASSERT_EQ(prepare_settings(testing_support::amber3m(), parameters, *work, *settings), ConfigureStatus::ok);
  planning.planner->adopt(*settings);
}

bool same_time(const PlanNode& a, const PlanNode& b) { return std::abs(a.time_s - b.time_s) < 1e-9; }

/// Node k is the first, or the second, of the two nodes of a touch-down.
bool before_touchdown(const Plan& plan, int k) {
  return k + 1 < plan.nodes &&
         same_time(plan.node[static_cast<std::size_t>(k)], plan.node[static_cast<std::size_t>(k + 1)]);
}
bool after_touchdown(const Plan& plan, int k) { return k > 0 && before_touchdown(plan, k - 1); }

/// The old plan at a time: its own node at a touch-down on that side, interpolated between nodes otherwise.
StateVector old_state(const Plan& old, double time_s, bool before, bool after) {
  for (int j = 0; j < old.nodes; ++j) {
    const PlanNode& node = old.node[static_cast<std::size_t>(j)];
    if (std::abs(node.time_s - time_s) > 1e-9) continue;
    if ((before && before_touchdown(old, j)) || (after && after_touchdown(old, j))) return node.state;
  }
  int j = 0;
  while (j + 2 < old.nodes && old.node[static_cast<std::size_t>(j + 1)].time_s <= time_s) ++j;
  const PlanNode& from = old.node[static_cast<std::size_t>(j)];
  const PlanNode& to = old.node[static_cast<std::size_t>(j + 1)];
  const double share = (time_s - from.time_s) / (to.time_s - from.time_s);
  return from.state + share * (to.state - from.state);
}

TEST(InitialGuess, IsThePlanBeforeWithBothSidesOfItsTouchDowns) {
  Planning planning(shipped());
  planning.advance(kWalk, 60);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  const auto old = std::make_unique<Plan>(*planning.plan);
  planning.follow();
  guess_only(planning);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  const Plan& guess = *planning.plan;
  const double old_end_s = old->node[static_cast<std::size_t>(old->nodes - 1)].time_s;
  double largest_jump_rad_s = 0.0;
  for (int k = 1; k < guess.nodes; ++k) {
    const PlanNode& node = guess.node[static_cast<std::size_t>(k)];
    if (node.time_s > old_end_s - 1e-9) continue;
    const bool before = before_touchdown(guess, k);
    const bool after = after_touchdown(guess, k);
    const StateVector expected = old_state(*old, node.time_s, before, after);
    EXPECT_LT((node.state - expected).cwiseAbs().maxCoeff(), 1e-9) << "node " << k << " at " << node.time_s;
    if (after) {
      const StateVector& earlier = guess.node[static_cast<std::size_t>(k - 1)].state;
      largest_jump_rad_s = std::max(largest_jump_rad_s, (node.state - earlier).cwiseAbs().maxCoeff());
    }
  }
  EXPECT_GT(largest_jump_rad_s, 0.1) << "the sides of a touch-down differ, so that a confusion shows";
}

TEST(InitialGuess, BehindATouchDownAtOnceIsThatBehindTheTouchDownOfThePlanBefore) {
  for (const double before_s : {0.0005, 0.001, 0.0015}) {
    Planning planning(shipped());
    planning.advance(kWalk, 130);
    const auto old = std::make_unique<Plan>(*planning.plan);
    planning.time_s = old->phase_end_s - before_s;
    planning.state = interpolate(*old, planning.time_s).state;
    guess_only(planning);
    ASSERT_TRUE(planning.solve(kWalk).usable());
    const Plan& guess = *planning.plan;
    ASSERT_TRUE(after_touchdown(guess, 1)) << "merged with the start";
    const StateVector expected = old_state(*old, old->phase_end_s, false, true);
    EXPECT_LT((guess.node[1].state - expected).cwiseAbs().maxCoeff(), 1e-9) << before_s;
  }
}

TEST(InitialGuess, TakesTheInputsOfThePlanBeforeWhereTheFeetAreTheSame) {
  Planning planning(shipped());
  planning.advance(kWalk, 60);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  const auto old = std::make_unique<Plan>(*planning.plan);
  planning.follow();
  guess_only(planning);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  const Plan& guess = *planning.plan;
  const double old_end_s = old->node[static_cast<std::size_t>(old->nodes - 1)].time_s;
  for (int k = 0; k + 1 < guess.nodes; ++k) {
    const PlanNode& node = guess.node[static_cast<std::size_t>(k)];
    if (node.time_s > old_end_s - 1e-9) break;
    if (before_touchdown(guess, k)) {
      EXPECT_EQ(node.input, model::InputVector::Zero()) << "node " << k;
      continue;
    }
    int j = 0;
    while (old->node[static_cast<std::size_t>(j + 1)].time_s <= node.time_s) ++j;
    ASSERT_TRUE(old->node[static_cast<std::size_t>(j)].mode == node.mode);
    EXPECT_EQ(node.input, old->node[static_cast<std::size_t>(j)].input) << "node " << k;
  }
}

TEST(InitialGuess, BeyondThePlanBeforeItsLastPostureMovesOnAtTheReferenceSpeed) {
  Planning planning(shipped());
  planning.advance(kWalk, 150);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  const PlanNode end = planning.plan->node[static_cast<std::size_t>(planning.plan->nodes - 1)];
  planning.time_s += 0.1;
  planning.state = interpolate(*planning.plan, planning.time_s).state;
  guess_only(planning);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  const double speed_m_s = planning.planner->problem().x_ref_terminal[kPositions];
  EXPECT_NEAR(speed_m_s, kWalk.speed_m_s, planning.parameters.reference.speed_trim_max_m_s);
  int beyond = 0;
  for (int k = 0; k < planning.plan->nodes; ++k) {
    const PlanNode& node = planning.plan->node[static_cast<std::size_t>(k)];
    if (node.time_s < end.time_s + 1e-9) continue;
    ++beyond;
    StateVector expected = end.state;
    expected[0] += (node.time_s - end.time_s) * speed_m_s;
    EXPECT_LT((node.state - expected).cwiseAbs().maxCoeff(), 1e-9) << "node " << k;
  }
  EXPECT_GE(beyond, 6);
}

TEST(InitialGuess, WithoutAPlanBeforeIsTheStateOnItsWayWithTheReference) {
  Planning planning(shipped());
  guess_only(planning);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  const ocp::Problem& problem = planning.planner->problem();
  for (int k = 1; k + 1 < planning.plan->nodes; ++k) {
    const PlanNode& node = planning.plan->node[static_cast<std::size_t>(k)];
    EXPECT_EQ(node.state.tail<model::kStates - 1>(), planning.state.tail<model::kStates - 1>());
    if (problem.horizon.stage[static_cast<std::size_t>(k)].kind != ocp::StageKind::flow) continue;
    const ocp::StagePlace& place = problem.place[k];
    EXPECT_EQ(node.state[0], problem.batch[place.batch].x_ref[0][place.lane]) << "node " << k;
    for (int i = 0; i < kInputs; ++i) {
      EXPECT_EQ(node.input[i], problem.batch[place.batch].u_ref[i][place.lane]) << "node " << k;
    }
  }
}

TEST(InitialGuess, HasNoForcesOfThePlanBeforeWhereOtherFeetStandNow) {
  Planning planning(shipped());
  planning.advance(testing_support::kStand, 20);
  guess_only(planning);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  int single_support = 0;
  for (int k = 0; k < planning.plan->nodes; ++k) {
    const PlanNode& node = planning.plan->node[static_cast<std::size_t>(k)];
    if (node.mode.count() != 1) continue;
    ++single_support;
    const int in_the_air = node.mode.left ? model::kRight : model::kLeft;
    EXPECT_EQ(node.input[model::kJoints + 2 * in_the_air], 0.0) << "node " << k;
    EXPECT_EQ(node.input[model::kJoints + 2 * in_the_air + 1], 0.0) << "node " << k;
  }
  EXPECT_GT(single_support, 10);
}

}  // namespace
}  // namespace stilt::control
