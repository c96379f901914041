#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "tests/mpc_core/sqp/solve.h"

namespace stilt::sqp {
namespace {

using model::kInputs;
using model::kStates;

bool same_bits(const ocp::Trajectory& a, const ocp::Trajectory& b, int stages) {
  return std::memcmp(a.x, b.x, sizeof(a.x[0]) * static_cast<std::size_t>(stages + 1)) == 0 &&
         std::memcmp(a.u, b.u, sizeof(a.u[0]) * static_cast<std::size_t>(stages)) == 0;
}

TEST(Sqp, ConvergesFromAColdStartWithinTwentyIterations) {
  for (const double horizon_s : {0.2, 0.5, 1.0, 2.0}) {
    testing_support::SceneOptions options;
    options.horizon_s = horizon_s;
    Solve solve(options);
    const SolveReport report = solve.run(20);
    EXPECT_EQ(report.status, SolveStatus::converged) << "horizon " << horizon_s;
    EXPECT_TRUE(report.usable());
    EXPECT_LT(solve.violation(), solve.parameters.violation_tolerance);
  }
}

TEST(Sqp, ReportsTheMeritOfTheIterateItLeaves) {
  Solve solve;
  const SolveReport report = solve.run(3);
  const ocp::Merit merit = solve.merit();
  EXPECT_EQ(report.cost, merit.cost);
  EXPECT_EQ(report.dynamics_defect_max, merit.dynamics_defect_max);
  EXPECT_EQ(report.equality_violation_max, merit.equality_violation_max);
}

TEST(Sqp, StopsAtTheIterationLimit) {
  Solve solve;
  const SolveReport report = solve.run(2);
  EXPECT_EQ(report.status, SolveStatus::iteration_limit);
  EXPECT_EQ(report.iterations, 2);
  EXPECT_TRUE(report.usable());
}

TEST(Sqp, UsesEveryIterationWithoutEarlyStop) {
  Solve solve;
  solve.parameters.early_stop = false;
  // At the solution rounding decides whether the filter accepts a step; one that it refuses costs 14 lengths.
  solve.parameters.backtracking_steps = 30 * 14;
  const SolveReport report = solve.run(30);
  EXPECT_EQ(report.status, SolveStatus::iteration_limit);
  EXPECT_EQ(report.iterations, 30);
}

TEST(Sqp, RejectsAStepThatTheFilterRefusesAndLeavesTheIterateAlone) {
  Solve solve;
  solve.parameters.filter_margin = 1e9;  // asks for more than any step can give
  const SolveReport report = solve.run();
  EXPECT_EQ(report.status, SolveStatus::step_rejected);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_EQ(report.line_search_step, 0.0);
  EXPECT_TRUE(report.usable());
  EXPECT_TRUE(same_bits(*solve.iterate, solve.scene->guess, solve.stages()));
}

TEST(Sqp, AStepThatTheFilterRefusesIsConvergenceWhenItVanishes) {
  Solve solve;
  solve.converge();
  solve.parameters.filter_margin = 1e9;
  solve.parameters.filter_violation_min = 0.0;
  solve.parameters.step_tolerance = 1e-3;
  const SolveReport report = solve.run();
  EXPECT_EQ(report.status, SolveStatus::converged);
  EXPECT_EQ(report.line_search_step, 0.0);
}

TEST(Sqp, ASettledCostIsNoConvergenceWhileConstraintsAreViolated) {
  Solve solve;
  solve.parameters.cost_tolerance = 1e12;
  solve.parameters.step_tolerance = 0.0;
  solve.parameters.violation_tolerance = 1e-6;
  const SolveReport report = solve.run(20);
  EXPECT_EQ(report.status, SolveStatus::converged);
  EXPECT_GT(report.iterations, 1);
  EXPECT_LT(solve.violation(), 1e-6);
}

TEST(Sqp, EndsWithItsLastIterateWhenTheBacktrackingStepsAreUsedUp) {
  for (const int most : {0, 5, 30}) {
    Solve solve;
    solve.parameters.early_stop = false;  // without a bound every iteration tries the same 14 lengths
    solve.parameters.filter_margin = 1e9;
    solve.parameters.backtracking_steps = most;
    const SolveReport report = solve.run(10);
    EXPECT_EQ(report.status, SolveStatus::iteration_limit);
    EXPECT_EQ(report.iterations, 1 + most / 14);
    EXPECT_EQ(report.trial_steps, report.iterations + most);
    EXPECT_EQ(report.line_search_step, 0.0);
    EXPECT_TRUE(same_bits(*solve.iterate, solve.scene->guess, solve.stages()));
  }
  Solve enough;
  Solve bounded;
  const SolveReport report = enough.run(20);
  bounded.parameters.backtracking_steps = report.trial_steps - report.iterations;
  EXPECT_EQ(bounded.run(20).trial_steps, report.trial_steps) << "a full step each is always tried";
  EXPECT_TRUE(same_bits(*bounded.iterate, *enough.iterate, enough.stages()));
}

TEST(Sqp, ARejectedLastStepHasNoLengthWhateverWasTakenBefore) {
  const auto prepared = [] {
    Solve solve;
    solve.parameters.early_stop = false;
    solve.parameters.armijo = 1e6;  // no step below filter_violation_min is good enough
    solve.parameters.filter_violation_min = 1e-3 * solve.violation();
    return solve;
  };
  Solve one_by_one = prepared();
  int accepted = 0;
  while (one_by_one.run(1).line_search_step > 0.0) ASSERT_LT(++accepted, 20);
  ASSERT_GT(accepted, 0);
  Solve together = prepared();
  const SolveReport report = together.run(accepted + 1);
  EXPECT_EQ(report.iterations, accepted + 1);
  EXPECT_EQ(report.line_search_step, 0.0);
  EXPECT_TRUE(same_bits(*together.iterate, *one_by_one.iterate, together.stages()));
}

TEST(Sqp, SaysNotFiniteForEveryPlaceANumberCanBeMissing) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto status = [&](const auto& spoil) {
      Solve solve;
      spoil(solve);
      const SolveReport report = solve.run();
      EXPECT_FALSE(report.usable());
      return report.status;
    };
    EXPECT_EQ(status([&](Solve& s) { s.iterate->x[3][2] = bad; }), SolveStatus::not_finite);
    EXPECT_EQ(status([&](Solve& s) { s.iterate->x[0][9] = bad; }), SolveStatus::not_finite);
    EXPECT_EQ(status([&](Solve& s) { s.iterate->u[5][1] = bad; }), SolveStatus::not_finite);
    EXPECT_EQ(status([&](Solve& s) { s.scene->problem.x_initial[4] = bad; }), SolveStatus::not_finite);
    EXPECT_EQ(status([&](Solve& s) { s.scene->problem.x_ref_terminal[4] = bad; }), SolveStatus::not_finite);
    EXPECT_EQ(status([&](Solve& s) { s.scene->data.terminal_weight[2][2] = bad; }), SolveStatus::not_finite);
    EXPECT_EQ(status([&](Solve& s) { s.scene->data.joint_parameters[1] = bad; }), SolveStatus::not_finite);
    EXPECT_EQ(status([&](Solve& s) { s.scene->problem.batch[0].foot_position_ref[1] = ocp::Batch(bad); }),
              SolveStatus::not_finite);
  }
}

TEST(Sqp, SaysNotConvexWhenAnInputIsRewarded) {
  Solve solve;
  for (int j = 0; j < model::kJoints; ++j) solve.scene->data.input_weight[j] = -100.0;
  const SolveReport report = solve.run();
  EXPECT_EQ(report.status, SolveStatus::not_convex);
  EXPECT_FALSE(report.usable());
}

TEST(Sqp, LeavesAViolationOfSecondOrderInTheStep) {
  double left[3];
  for (int halving = 0; halving < 3; ++halving) {
    Solve solve;
    solve.converge();
    testing_support::disturb(*solve.iterate, solve.stages(), 0.02 * std::pow(0.5, halving), 17);
    const SolveReport report = solve.run(1);
    ASSERT_EQ(report.line_search_step, 1.0);
    left[halving] = solve.violation();
  }
  EXPECT_NEAR(left[0] / left[1], 4.0, 0.4);
  EXPECT_NEAR(left[1] / left[2], 4.0, 0.2);
}

TEST(Sqp, ViolationFallsFasterAndFasterFromAColdStart) {
  Solve solve;
  solve.parameters.early_stop = false;
  double ratio = 1.0;
  double before = solve.violation();
  for (int iteration = 0; iteration < 12 && before > 1e-9; ++iteration) {
    (void)solve.run(1);
    const double now = solve.violation();
    if (before < 0.1) {  // near the solution
      EXPECT_LT(now, 0.3 * before) << "iteration " << iteration;
    }
    ratio = now / before;
    before = now;
  }
  EXPECT_LT(before, 1e-9);
  EXPECT_LT(ratio, 0.2);
}

TEST(Sqp, NeedsAtMostOneIterationFromItsOwnSolution) {
  Solve solve;
  solve.converge();
  const double cost = solve.merit().cost;
  const SolveReport report = solve.run(10);
  EXPECT_EQ(report.status, SolveStatus::converged);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_NEAR(report.cost, cost, 1e-9 * std::abs(cost));
}

TEST(Sqp, NeedsAFewIterationsAfterADisturbanceOfTheMeasuredState) {
  Solve solve;
  solve.converge();
  for (int i = 0; i < kStates; ++i) {
    solve.scene->problem.x_initial[i] += (i < model::kPositions ? 0.01 : 0.1) * std::sin(i);
    solve.iterate->x[0][i] = solve.scene->problem.x_initial[i];
  }
  const SolveReport report = solve.run(10);
  EXPECT_EQ(report.status, SolveStatus::converged);
  EXPECT_LE(report.iterations, 5);  // the steep friction cone takes one more than a soft one
}

TEST(Sqp, ClosesAGapToTheMeasuredStateWithAFullStep) {
  Solve solve;
  for (int i = 0; i < kStates; ++i) solve.scene->problem.x_initial[i] += 0.005;
  const SolveReport report = solve.run(1);
  ASSERT_EQ(report.line_search_step, 1.0);
  for (int i = 0; i < kStates; ++i)
    EXPECT_NEAR(solve.iterate->x[0][i], solve.scene->problem.x_initial[i], 1e-15);
}

TEST(Sqp, GivesTheSameBitsForTheSameInputWhateverItSolvedBefore) {
  Solve first;
  (void)first.run(4);

  testing_support::SceneOptions other_options;
  other_options.horizon_s = 1.5;
  other_options.command.speed_m_s = -0.2;
  Solve second(other_options);
  (void)second.run(7);  // leaves its workspace full of another problem
  Solve fresh;
  second.scene = std::move(fresh.scene);
  *second.iterate = *fresh.iterate;
  (void)second.run(4);
  EXPECT_TRUE(same_bits(*first.iterate, *second.iterate, first.stages()));
}

TEST(Sqp, FeedbackGainIsHowTheStepFollowsTheState) {
  Solve one;
  (void)one.run(2);
  Solve two;
  *two.iterate = *one.iterate;
  for (int i = 0; i < kStates; ++i) two.scene->problem.x_initial[i] += 1e-4 * std::cos(3.0 * i);
  ASSERT_EQ(one.run(1).line_search_step, 1.0);
  ASSERT_EQ(two.run(1).line_search_step, 1.0);
  // Both steps come from the same quadratic model: their difference is the feedback.
  for (int k = 0; k < one.stages(); ++k) {
    Eigen::Matrix<double, kInputs, kStates> gain;
    two.sqp->feedback_gain(k, gain);
    const model::StateVector dx = Eigen::Map<const model::StateVector>(two.iterate->x[k]) -
                                  Eigen::Map<const model::StateVector>(one.iterate->x[k]);
    const model::InputVector du = Eigen::Map<const model::InputVector>(two.iterate->u[k]) -
                                  Eigen::Map<const model::InputVector>(one.iterate->u[k]);
    ASSERT_LT((gain * dx - du).norm(), 1e-8 * (1e-3 + du.norm())) << "stage " << k;
  }
}

TEST(Sqp, WithBothLegsStraightAndFeetTogetherTakesABoundedStep) {
  for (const gait::GaitKind kind : {gait::GaitKind::stand, gait::GaitKind::walk}) {
    testing_support::SceneOptions options;
    options.command.kind = kind;
    Solve solve(options);
    for (int k = 0; k <= solve.stages(); ++k) {
      double* x = solve.iterate->x[k];
      std::fill(x + 2, x + kStates, 0.0);
      x[1] = 0.8731;
    }
    std::copy(solve.iterate->x[0], solve.iterate->x[0] + kStates, solve.scene->problem.x_initial);
    const SolveReport report = solve.run(1);
    EXPECT_TRUE(report.usable());
    EXPECT_LT(report.step_component_max, 1e4);
  }
}

long long g_ticks = 0;
long long counting_clock() noexcept { return g_ticks += 1000; }

TEST(Sqp, MeasuresItsPhasesWithTheClockItIsGivenAndNoneWithout) {
  Solve solve;
  (void)solve.run(3);
  EXPECT_EQ(solve.sqp->phase_times().total_us, 0.0);
  solve.sqp->set_clock(&counting_clock);
  const SolveReport report = solve.run(3);
  const PhaseTimes& times = solve.sqp->phase_times();
  EXPECT_GE(times.linearise_us, report.iterations) << "a group of batches at a time, beside the sweep";
  EXPECT_GE(times.riccati_us, report.iterations);
  EXPECT_EQ(times.line_search_us, report.iterations);
  EXPECT_GE(times.total_us, times.linearise_us + times.riccati_us + times.line_search_us);
}

TEST(Sqp, MeasuresALineSearchThatGivesUp) {
  for (const int most : {0, 5}) {
    Solve solve;
    solve.sqp->set_clock(&counting_clock);
    solve.parameters.filter_margin = 1e9;
    solve.parameters.backtracking_steps = most;
    EXPECT_EQ(solve.run(3).iterations, 1);
    EXPECT_EQ(solve.sqp->phase_times().line_search_us, 1.0) << most;
  }
}

}  // namespace
}  // namespace stilt::sqp
