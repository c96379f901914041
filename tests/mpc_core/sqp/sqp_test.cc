#include "mpc_core/sqp/sqp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "mpc_core/sqp/terminal_cost.h"
#include "tests/mpc_core/ocp/planning_scene.h"

namespace stilt::sqp {
namespace {

using model::kInputs;
using model::kStates;
using testing_support::Scene;

/// A walking problem with its terminal cost, a solver, and an iterate that starts from the guess.
struct Solve {
  std::unique_ptr<Scene> scene;
  std::unique_ptr<Sqp> sqp = std::make_unique<Sqp>();
  std::unique_ptr<ocp::Trajectory> iterate;
  SqpParameters parameters;

  explicit Solve(const testing_support::SceneOptions& options = {})
      : scene(testing_support::walking_scene(options)) {
    const model::StateVector standing =
        gait::standing_state(options.robot->constants, options.reference.base_height_m, 0.0, 0.15, true);
    EXPECT_TRUE(set_terminal_cost(scene->data, standing, *std::make_unique<TerminalCostWorkspace>()));
    iterate = std::make_unique<ocp::Trajectory>(scene->guess);
  }

  SolveReport run() { return sqp->solve(scene->data, scene->problem, parameters, *iterate); }
  SolveReport run(int iterations) {
    parameters.iterations = iterations;
    return run();
  }
  /// The solution to about nine digits: the next step, smaller still, changes the cost by its rounding.
  void converge() {
    const SqpParameters before = parameters;
    parameters.cost_tolerance = 0.0;
    parameters.step_tolerance = 1e-6;
    parameters.iterations = 100;
    EXPECT_EQ(run().status, SolveStatus::converged);
    parameters = before;
  }
  [[nodiscard]] int stages() const { return scene->problem.horizon.stages; }
  [[nodiscard]] ocp::Merit merit() const { return ocp::evaluate(scene->data, scene->problem, *iterate); }
  [[nodiscard]] double violation() const { return std::sqrt(merit().violation_squared); }
};

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
  EXPECT_EQ(report.dynamics_defect_max, merit.defect_max);
  EXPECT_EQ(report.equality_violation_max, merit.equality_max);
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
  EXPECT_EQ(report.step_length, 0.0);
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
  EXPECT_EQ(report.step_length, 0.0);
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
    EXPECT_EQ(report.step_length, 0.0);
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
  while (one_by_one.run(1).step_length > 0.0) ASSERT_LT(++accepted, 20);
  ASSERT_GT(accepted, 0);
  Solve together = prepared();
  const SolveReport report = together.run(accepted + 1);
  EXPECT_EQ(report.iterations, accepted + 1);
  EXPECT_EQ(report.step_length, 0.0);
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
    ASSERT_EQ(report.step_length, 1.0);
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
  EXPECT_LE(report.iterations, 4);
}

TEST(Sqp, ClosesAGapToTheMeasuredStateWithAFullStep) {
  Solve solve;
  for (int i = 0; i < kStates; ++i) solve.scene->problem.x_initial[i] += 0.005;
  const SolveReport report = solve.run(1);
  ASSERT_EQ(report.step_length, 1.0);
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
  ASSERT_EQ(one.run(1).step_length, 1.0);
  ASSERT_EQ(two.run(1).step_length, 1.0);
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

TEST(SqpFilter, AboveGMaxTakesOnlyWhatReducesTheViolation) {
  Solve solve;
  solve.parameters.filter_violation_max = 0.0;
  double before = solve.violation();
  for (int iteration = 0; iteration < 20; ++iteration) {
    if (solve.run(1).step_length == 0.0) break;  // no step was taken
    const double now = solve.violation();
    ASSERT_LT(now, before);
    before = now;
  }
  EXPECT_LT(before, 1e-6);
}

TEST(SqpFilter, BelowGMinAsksForDescentOfTheCost) {
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

TEST(SqpFilter, BelowGMinAShorterStepNeedsDescendLessInProportion) {
  // Of a quadratic cost a full step gains half of what its slope promises, half a step three quarters.
  const auto step_length = [](double armijo) {
    Solve solve;
    solve.converge();
    solve.scene->data.cost.foot_velocity *= 1.01;
    solve.parameters.filter_violation_min = 1e3;
    solve.parameters.armijo = armijo;
    return solve.run(1).step_length;
  };
  EXPECT_EQ(step_length(0.45), 1.0);
  EXPECT_EQ(step_length(0.55), 0.5);
  EXPECT_EQ(step_length(0.70), 0.5);
  EXPECT_EQ(step_length(0.80), 0.25);
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

/// Below g_min a full step is accepted up to the factor of Armijo at which cost(1) = cost(0) + factor slope.
/// The slope is exact to first order in the violation of the constraints.
TEST(SqpFilter, BelowGMinAsksForDescentByTheSlopeOfTheCost) {
  Solve start;
  start.converge();
  disturb_inputs(start);
  const auto step_with = [&start](double armijo) {
    Solve solve;
    *solve.iterate = *start.iterate;
    solve.parameters.filter_violation_min = solve.parameters.filter_violation_max = 1e12;
    solve.parameters.armijo = armijo;
    const bool full = solve.run(1).step_length == 1.0;
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
    const double halvings = -std::log2(report.step_length);
    EXPECT_EQ(halvings, std::round(halvings)) << "seed " << seed;
    shortened = shortened || report.step_length < 1.0;
  }
  EXPECT_TRUE(shortened);
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
    EXPECT_LT(report.step_size, 1e4);
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

}  // namespace
}  // namespace stilt::sqp
