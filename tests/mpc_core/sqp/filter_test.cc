#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/mpc_core/sqp/solve.h"

/// Which trial steps the filter of the line search accepts.
namespace stilt::sqp {
namespace {

using model::kInputs;
using model::kStates;

TEST(SqpFilter, AboveViolationMaxTakesOnlyWhatReducesTheViolation) {
  Solve solve;
  solve.parameters.filter_violation_max = 0.0;
  double before = solve.violation();
  for (int iteration = 0; iteration < 20; ++iteration) {
    if (solve.run(1).line_search_step == 0.0) break;  // no step was taken
    const double now = solve.violation();
    ASSERT_LT(now, before);
    before = now;
  }
  EXPECT_LT(before, 1e-6);
}

TEST(SqpFilter, BelowViolationMinAsksForDescentOfTheCost) {
  const auto status = [](double armijo) {
    Solve solve;
    solve.converge();
    solve.scene->data.cost.foot_velocity *= 1.5;  // feasible as before, but no longer the best
    solve.parameters.filter_violation_min = 1e3;
    solve.parameters.armijo = armijo;
    return solve.run(1).status;
  };
  EXPECT_EQ(status(1e-4), SolveStatus::iteration_limit);
  EXPECT_EQ(status(1e6), SolveStatus::step_rejected);
}

TEST(SqpFilter, BelowViolationMinAShorterStepNeedsDescendLessInProportion) {
  // Of a quadratic cost a full step gains half of what its slope promises, half a step three quarters.
  const auto taken_step = [](double armijo) {
    Solve solve;
    solve.converge();
    solve.scene->data.cost.foot_velocity *= 1.01;
    solve.parameters.filter_violation_min = 1e3;
    solve.parameters.armijo = armijo;
    return solve.run(1).line_search_step;
  };
  EXPECT_EQ(taken_step(0.45), 1.0);
  EXPECT_EQ(taken_step(0.55), 0.5);
  EXPECT_EQ(taken_step(0.70), 0.5);
  EXPECT_EQ(taken_step(0.80), 0.25);
}

/// The start is off its optimum and off the equality constraints of the inputs, and costs more than the
/// optimum.
void disturb_inputs(Solve& solve) {
  const double least = solve.merit().cost;
  for (const double size_rad_s2 : {1e-3, -2e-3}) {
    for (int k = 0; k < solve.stages(); ++k) {
      for (int j = 0; j < model::kJoints; ++j) solve.iterate->u[k][j] += size_rad_s2 * std::sin(k + j);
    }
    if (solve.merit().cost > least) return;
  }
}

/// Below filter_violation_min a full step is accepted up to the factor of Armijo at which cost(1) = cost(0) +
/// factor slope. The slope is exact to first order in the violation of the constraints.
TEST(SqpFilter, BelowViolationMinAsksForDescentByTheSlopeOfTheCost) {
  Solve start;
  start.converge();
  disturb_inputs(start);
  const auto step_with = [&start](double armijo) {
    Solve solve;
    *solve.iterate = *start.iterate;
    solve.parameters.filter_violation_min = solve.parameters.filter_violation_max = 1e12;
    solve.parameters.armijo = armijo;
    const bool full = solve.run(1).line_search_step == 1.0;
    return std::pair{full, std::move(solve)};
  };
  const auto [taken, full] = step_with(0.0);
  ASSERT_TRUE(taken);
  const double cost = start.merit().cost;
  double low = 0.0;
  double high = 10.0;
  ASSERT_FALSE(step_with(high).first);
  for (int i = 0; i < 50; ++i) (step_with(0.5 * (low + high)).first ? low : high) = 0.5 * (low + high);
  const double slope = (full.merit().cost - cost) / low;

  const auto cost_after = [&](double length) {
    Solve moved;
    for (int k = 0; k <= start.stages(); ++k) {
      for (int i = 0; i < kStates; ++i) {
        const double from = start.iterate->x[k][i];
        moved.iterate->x[k][i] = from + length * (full.iterate->x[k][i] - from);
      }
    }
    for (int k = 0; k < start.stages(); ++k) {
      for (int i = 0; i < kInputs; ++i) {
        const double from = start.iterate->u[k][i];
        moved.iterate->u[k][i] = from + length * (full.iterate->u[k][i] - from);
      }
    }
    return moved.merit().cost;
  };
  constexpr double kLength = 0.1;
  const double expected = (cost_after(kLength) - cost_after(-kLength)) / (2.0 * kLength);
  EXPECT_LT(expected, 0.0);
  EXPECT_NEAR(slope, expected, 0.01 * std::abs(expected));
}

TEST(SqpFilter, OtherwiseTakesEitherASmallerViolationOrASmallerCost) {
  // Cold start: the violation falls while the cost rises.
  Solve infeasible;
  const ocp::Merit cold = infeasible.merit();
  ASSERT_EQ(infeasible.run(1).status, SolveStatus::iteration_limit);
  EXPECT_LT(infeasible.merit().violation_squared, cold.violation_squared);

  // Feasible, but not the best: the cost falls while the violation rises.
  Solve feasible;
  feasible.converge();
  feasible.scene->data.cost.foot_velocity *= 1.5;
  feasible.parameters.filter_violation_min = 0.0;
  const ocp::Merit before = feasible.merit();
  ASSERT_EQ(feasible.run(1).status, SolveStatus::iteration_limit);
  EXPECT_LT(feasible.merit().cost, before.cost);
  EXPECT_GT(feasible.merit().violation_squared, before.violation_squared);
}

TEST(SqpFilter, ShortensTheStepByPowersOfTheFactorUntilOneIsAccepted) {
  bool shortened = false;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Solve solve;
    testing_support::disturb(*solve.iterate, solve.stages(), 1.5, seed);
    const SolveReport report = solve.run(1);
    ASSERT_TRUE(report.usable()) << "seed " << seed;
    const double halvings = -std::log2(report.line_search_step);
    EXPECT_EQ(halvings, std::round(halvings)) << "seed " << seed;
    shortened = shortened || report.line_search_step < 1.0;
  }
  EXPECT_TRUE(shortened);
}

}  // namespace
}  // namespace stilt::sqp
