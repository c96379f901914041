#include "mpc_core/lq/riccati.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/mpc_core/lq/random_lq.h"

namespace stilt::lq {
namespace {

using namespace testing;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

LqProblem ordinary_problem(int count = 20) { return random_problem(7, count); }

SweepStatus status_of(const LqProblem& problem) {
  SweepStatus status;
  (void)solve(problem, status);
  return status;
}

/// First stage at or after `from` with free inputs.
int stage_with_inputs(const LqProblem& problem, int from) {
  while (problem.stages[from].free_inputs == 0) ++from;
  return from;
}

TEST(Riccati, SolutionsOf500RandomProblemsSatisfyTheirKktConditions) {
  std::mt19937_64 random(20240611);
  for (int trial = 0; trial < 500; ++trial) {
    const std::uint64_t seed = random();
    const int count = std::uniform_int_distribution<int>(1, 160)(random);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", stages " + std::to_string(count));
    const LqProblem problem = random_problem(seed, count);
    SweepStatus status;
    const LqSolution solution = solve(problem, status);
    ASSERT_TRUE(status.ok()) << "stage " << status.stage;
    const KktResidual residual = kkt_residual(problem, solution);
    ASSERT_LE(residual.state, 1e-9);
    ASSERT_LE(residual.input, 1e-9);
    ASSERT_LE(residual.dynamics, 1e-9);
  }
}

TEST(Riccati, ShortHorizonsAgreeWithADenseSolveOfTheKktSystem) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const LqProblem problem = random_problem(seed, 1 + static_cast<int>(seed % 8));
    SweepStatus status;
    const LqSolution solution = solve(problem, status);
    ASSERT_TRUE(status.ok());
    const Vector dense = dense_kkt_solution(problem);
    const double scale = 1.0 + dense.cwiseAbs().maxCoeff();
    int at = 0;
    for (int k = 0; k < problem.count(); ++k) {
      for (int i = 0; i < problem.stages[k].free_inputs; ++i) {
        ASSERT_NEAR(solution.steps[k].w[i], dense[at++], 1e-9 * scale) << "input " << i << " of stage " << k;
      }
      for (int i = 0; i < kStates; ++i) {
        ASSERT_NEAR(solution.steps[k + 1].x[i], dense[at++], 1e-9 * scale)
            << "state " << i << " of " << k + 1;
      }
    }
  }
}

TEST(Riccati, EveryKindOfStageHasItsKernel) {
  for (const StageKind kind : kKinds) {
    SCOPED_TRACE("free inputs " + std::to_string(kind.free_inputs) + ", constraints " +
                 std::to_string(kind.constraints));
    std::mt19937_64 random(100 + kind.free_inputs);
    LqProblem problem = random_problem(3, 0);
    const int count = kind.free_inputs > 0 ? 200 : 8;  // nothing stabilises a row of transitions
    for (int k = 0; k < count; ++k) add_stage(random, kind, 0.1, problem);
    SweepStatus status;
    const LqSolution solution = solve(problem, status);
    ASSERT_TRUE(status.ok());
    EXPECT_LE(kkt_residual(problem, solution).worst(), 1e-9);
  }
}

TEST(Riccati, StepsHoldTheProductsWithTheConstraintRows) {
  const LqProblem problem = ordinary_problem(40);
  SweepStatus status;
  const LqSolution solution = solve(problem, status);
  ASSERT_TRUE(status.ok());
  for (int k = 0; k <= problem.count(); ++k) {
    const int constraints = k < problem.count() ? problem.stages[k].constraints : 0;
    for (int i = 0; i < kMaxConstraints; ++i) {
      if (i >= constraints) {
        ASSERT_EQ(solution.steps[k].c[i], 0.0) << "stage " << k;
        continue;
      }
      const Vector row = dense_state(problem.stages[k].G[kBaseRows + i]),
                   x = dense_state(solution.steps[k].x);
      ASSERT_NEAR(solution.steps[k].c[i], row.dot(x), 1e-13 * row.norm() * x.norm()) << "stage " << k;
    }
  }
}

TEST(Riccati, StepsHoldTheInputsAndTheSlopeOfTheCost) {
  const LqProblem problem = ordinary_problem(60);
  SweepStatus status;
  const LqSolution solution = solve(problem, status);
  ASSERT_TRUE(status.ok());
  double slope = dense_state(problem.terminal.q).dot(dense_state(solution.steps.back().x));
  double scale = 1.0;
  for (int k = 0; k < problem.count(); ++k) {
    const LqStage& stage = problem.stages[k];
    const InputProjection& inputs = problem.inputs[k];
    const LqStep& step = solution.steps[k];
    using Input = Eigen::Map<const Eigen::Matrix<double, model::kInputs, 1>>;
    Vector expected = Input(inputs.u0);
    slope += inputs.u0_slope + dense_state(stage.q).dot(dense_state(step.x));
    for (int i = 0; i < stage.constraints; ++i) expected += step.c[i] * Input(inputs.Y[i]);
    for (int i = 0; i < stage.free_inputs; ++i) {
      expected += step.w[i] * Input(inputs.W[i]);
      slope += stage.r[i] * step.w[i];
    }
    for (int axis = 0; axis < 2 && inputs.first_force >= 0; ++axis) {
      expected[inputs.first_force + axis] += dense_state(inputs.F[axis]).dot(dense_state(step.x));
    }
    const double size = 1.0 + expected.cwiseAbs().maxCoeff() + dense_state(step.x).cwiseAbs().maxCoeff();
    ASSERT_LE((Input(step.u) - expected).cwiseAbs().maxCoeff(), 1e-12 * size) << "stage " << k;
    scale += size * size;
  }
  EXPECT_NEAR(solution.slope, slope, 1e-12 * scale);
}

TEST(Riccati, AHorizonWithoutStagesIsItsTerminalCost) {
  const LqProblem problem = random_problem(5, 0);
  SweepStatus status;
  const LqSolution solution = solve(problem, status);
  EXPECT_TRUE(status.ok());
  EXPECT_LE(kkt_residual(problem, solution).worst(), 1e-14);
}

TEST(Riccati, CostToGoIsExactlySymmetricAndItsPaddingZero) {
  SweepStatus status;
  const LqSolution solution = solve(ordinary_problem(40), status);
  ASSERT_TRUE(status.ok());
  for (const ValueFunction& value : solution.values) {
    for (int c = 0; c < kStates; ++c) {
      for (int r = 0; r < kStates; ++r) ASSERT_EQ(value.P[c][r], value.P[r][c]);
      for (int r = kStates; r < kRows; ++r) ASSERT_EQ(value.P[c][r], 0.0);
    }
    for (int r = kStates; r < kRows; ++r) ASSERT_EQ(value.p[r], 0.0);
  }
}

TEST(Riccati, GainsAndStepsBeyondTheFreeInputsAreZero) {
  const LqProblem problem = ordinary_problem(40);
  SweepStatus status;
  const LqSolution solution = solve(problem, status);
  ASSERT_TRUE(status.ok());
  for (int k = 0; k < problem.count(); ++k) {
    for (int i = 0; i < kMaxFreeInputs; ++i) {
      const bool free = i < problem.stages[k].free_inputs;
      for (int r = free ? kStates : 0; r < kRows; ++r) ASSERT_EQ(solution.gains[k].K[i][r], 0.0);
      if (!free) {
        ASSERT_EQ(solution.gains[k].k[i], 0.0);
        ASSERT_EQ(solution.steps[k].w[i], 0.0);
      }
    }
    for (int r = kStates; r < kRows; ++r) ASSERT_EQ(solution.steps[k].x[r], 0.0);
  }
}

TEST(Riccati, TheStepIsADescentDirectionWhoseSlopeMatchesDifferences) {
  LqProblem problem = ordinary_problem();
  for (LqStage& stage : problem.stages) std::memset(stage.b, 0, sizeof(stage.b));
  std::memset(problem.x0, 0, sizeof(problem.x0));
  SweepStatus status;
  const LqSolution solution = solve(problem, status);
  ASSERT_TRUE(status.ok());
  double slope = solution.slope;
  for (const InputProjection& inputs : problem.inputs) slope -= inputs.u0_slope;
  double curvature = 0.0;  // at the optimum of a problem without offsets it is minus the slope
  for (int k = 0; k < problem.count(); ++k) {
    const DenseStage s = dense(problem.stages[k]);
    const Vector x = dense_state(solution.steps[k].x);
    const Vector w = Eigen::Map<const Vector>(solution.steps[k].w, problem.stages[k].free_inputs);
    curvature += x.dot(s.Q * x) + w.dot(s.R * w) + 2.0 * w.dot(s.S * x);
  }
  const Vector last = dense_state(solution.steps.back().x);
  curvature += last.dot(baseline_terminal_hessian(problem.terminal) * last);
  EXPECT_LT(slope, 0.0);
  EXPECT_NEAR(slope, -curvature, 1e-9 * curvature);
}

TEST(Riccati, RepeatsBitForBit) {
  const LqProblem problem = ordinary_problem(134);
  SweepStatus status;
  const LqSolution first = solve(problem, status), second = solve(problem, status);
  const auto bytes = [&](const LqSolution& s) {
    return std::string(reinterpret_cast<const char*>(s.steps.data()), s.steps.size() * sizeof(LqStep)) +
           std::string(reinterpret_cast<const char*>(s.gains.data()), s.gains.size() * sizeof(LqGain));
  };
  EXPECT_EQ(bytes(first), bytes(second));
}

TEST(Riccati, ReadsTheLowerTrianglesOfQAndRAlone) {
  LqProblem problem = ordinary_problem(30);
  SweepStatus status;
  const LqSolution whole = solve(problem, status);
  for (LqStage& stage : problem.stages) {
    for (int i = 0; i < stage.free_inputs; ++i) {
      for (int c = i + 1; c < stage.free_inputs; ++c) stage.R[c][i] = kNaN;
    }
    for (int c = 0; c < kStates; ++c) {
      for (int r = 0; r < c; ++r) stage.Q[c][r] = kNaN;
    }
  }
  const LqSolution lower = solve(problem, status);
  ASSERT_TRUE(status.ok());
  EXPECT_EQ(std::memcmp(whole.steps[30].x, lower.steps[30].x, sizeof(double) * kRows), 0);
}

TEST(Riccati, AnIndefiniteStageIsNamed) {
  LqProblem problem = ordinary_problem();
  const int bad = stage_with_inputs(problem, 5);
  for (auto& column : problem.stages[bad].R) {
    for (double& entry : column) entry = 0.0;
  }
  problem.stages[bad].R[0][0] = -1e6;
  const SweepStatus status = status_of(problem);
  EXPECT_EQ(status.outcome, SweepOutcome::not_positive_definite);
  EXPECT_EQ(status.stage, bad);
}

TEST(Riccati, ASingularInputHessianCountsAsNotPositiveDefinite) {
  LqProblem problem = ordinary_problem();
  const int bad = stage_with_inputs(problem, 5);
  LqStage& stage = problem.stages[bad];
  std::memset(stage.B, 0, sizeof(stage.B));
  for (auto& column : stage.R) {
    for (double& entry : column) entry = 1.0;
  }
  const SweepStatus status = status_of(problem);
  EXPECT_EQ(status.outcome, SweepOutcome::not_positive_definite);
  EXPECT_EQ(status.stage, bad);
}

TEST(Riccati, NaNOrInfinityAnywhereIsReported) {
  const auto expect_not_finite = [](const char* where, auto&& spoil) {
    for (const double bad : {kNaN, kInfinity, -kInfinity}) {
      for (const int at : {0, 9, 19}) {
        LqProblem problem = ordinary_problem();
        const int k = at == 19 ? at : stage_with_inputs(problem, at);
        spoil(problem, problem.stages[k], bad);
        const SweepStatus status = status_of(problem);
        EXPECT_FALSE(status.ok()) << where << ", stage " << k << ", value " << bad;
        if (std::isnan(bad)) {
          EXPECT_EQ(status.outcome, SweepOutcome::not_finite) << where << ", stage " << k;
        }
      }
    }
  };
  expect_not_finite("G", [](LqProblem&, LqStage& s, double v) { s.G[3][5] = v; });
  expect_not_finite("L",
                    [](LqProblem&, LqStage& s, double v) { s.constraints ? s.L[0][11] = v : s.b[1] = v; });
  expect_not_finite(
      "h", [](LqProblem&, LqStage& s, double v) { s.form == StageForm::flow ? s.h = v : s.b[1] = v; });
  expect_not_finite("B",
                    [](LqProblem&, LqStage& s, double v) { s.free_inputs ? s.B[1][12] = v : s.b[1] = v; });
  expect_not_finite("Q", [](LqProblem&, LqStage& s, double v) { s.Q[3][5] = v; });
  expect_not_finite("S",
                    [](LqProblem&, LqStage& s, double v) { s.free_inputs ? s.S[1][5] = v : s.b[1] = v; });
  expect_not_finite("R",
                    [](LqProblem&, LqStage& s, double v) { s.free_inputs ? s.R[0][1] = v : s.b[1] = v; });
  expect_not_finite("b", [](LqProblem&, LqStage& s, double v) { s.b[13] = v; });
  expect_not_finite("q", [](LqProblem&, LqStage& s, double v) { s.q[0] = v; });
  expect_not_finite("r", [](LqProblem&, LqStage& s, double v) { s.free_inputs ? s.r[1] = v : s.b[1] = v; });
  expect_not_finite("terminal Q", [](LqProblem& p, LqStage&, double v) { p.terminal.Q[3][5] = v; });
  expect_not_finite("terminal q", [](LqProblem& p, LqStage&, double v) { p.terminal.q[2] = v; });
}

TEST(Riccati, AStageThatIsNoContactModeIsRefused) {
  constexpr StageKind kRefused[] = {{StageForm::flow, -1, 1}, {StageForm::flow, 5, 1},
                                    {StageForm::flow, 0, 0},  {StageForm::flow, 3, 2},
                                    {StageForm::flow, 4, 1},  {StageForm::transition, 3, 1}};
  for (const StageKind kind : kRefused) {
    LqProblem problem = ordinary_problem();
    problem.stages[4].form = kind.form;
    problem.stages[4].free_inputs = kind.free_inputs;
    problem.stages[4].constraints = kind.constraints;
    const SweepStatus status = status_of(problem);
    EXPECT_EQ(status.outcome, SweepOutcome::bad_input_count);
    EXPECT_EQ(status.stage, 4);
  }
}

}  // namespace
}  // namespace stilt::lq
