#include "mpc_core/lq/care.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>

namespace stilt::lq {
namespace {

constexpr int kN = model::kStates;
constexpr int kM = model::kInputs;
using Dense = Eigen::MatrixXd;

template <class Matrix>
Matrix gaussian(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Matrix::NullaryExpr([&] { return normal(random); });
}

/// Random open loop (unstable, as a rule), weights spread over three decades.
CareProblem random_problem(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> exponent(-1.5, 1.5);
  CareProblem problem{gaussian<StateMatrix>(random), gaussian<InputMatrix>(random), StateMatrix::Zero(),
                      InputWeight::Zero()};
  for (int i = 0; i < kN; ++i) problem.Q(i, i) = std::pow(10.0, exponent(random));
  for (int i = 0; i < kM; ++i) problem.R(i, i) = std::pow(10.0, exponent(random));
  return problem;
}

CareOutcome solve(const CareProblem& problem, CareSolution& solution) {
  static CareWorkspace work;
  return solve_care(problem, solution, work);
}

/// The residual, written down once more.
double residual(const CareProblem& problem, const Dense& S) {
  const Dense A = problem.A, B = problem.B, Q = problem.Q, R = problem.R;
  const Dense SA = S * A, SGS = S * B * R.inverse() * B.transpose() * S;
  return (SA + SA.transpose() - SGS + Q).norm() / (2.0 * SA.norm() + SGS.norm() + Q.norm());
}

double slowest_pole(const CareProblem& problem, const FeedbackMatrix& feedback) {
  const Dense A = problem.A, B = problem.B, K = feedback;
  return Dense(A - B * K).eigenvalues().real().maxCoeff();
}

/// S from the stable eigenvectors [X; Y] of the Hamiltonian: S = Y X^-1.
Dense solution_by_eigenvectors(const CareProblem& problem) {
  const Dense A = problem.A, B = problem.B, Q = problem.Q, R = problem.R;
  Dense hamiltonian(2 * kN, 2 * kN);
  hamiltonian << A, -B * R.inverse() * B.transpose(), -Q, -A.transpose();
  const Eigen::ComplexEigenSolver<Dense> eigen(hamiltonian);
  Eigen::MatrixXcd stable(2 * kN, kN);
  int found = 0;
  for (int i = 0; i < 2 * kN; ++i) {
    if (eigen.eigenvalues()[i].real() < 0.0 && found < kN) stable.col(found++) = eigen.eigenvectors().col(i);
  }
  return (stable.bottomRows(kN) * stable.topRows(kN).inverse()).real();
}

void expect_good(const CareProblem& problem) {
  CareSolution solution;
  ASSERT_EQ(solve(problem, solution), CareOutcome::ok);
  EXPECT_LE(residual(problem, solution.S), 1e-11);
  EXPECT_NEAR(solution.residual, residual(problem, solution.S), 1e-13);
  EXPECT_EQ(solution.S, solution.S.transpose());
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Dense>(solution.S).eigenvalues().minCoeff(),
            -1e-12 * solution.S.norm());
  EXPECT_LT(slowest_pole(problem, solution.K), 0.0);
}

TEST(Care, SolutionsOfRandomProblemsHaveASmallResidualAndAStableLoop) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_good(random_problem(seed));
  }
}

/// Without refinement the residual is up to 1e-10.
TEST(Care, StatesOfUnitsThatDifferByDecadesKeepASmallResidual) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed + 1000);
    std::uniform_real_distribution<double> exponent(-3.0, 3.0);
    CareProblem problem = random_problem(seed);
    for (int i = 0; i < kN; ++i) {
      const double unit = std::pow(10.0, exponent(random));
      problem.A.row(i) *= unit;
      problem.A.col(i) /= unit;
      problem.B.row(i) *= unit;
      problem.Q(i, i) /= unit * unit;
    }
    CareSolution solution;
    ASSERT_EQ(solve(problem, solution), CareOutcome::ok);
    EXPECT_LE(residual(problem, solution.S), 1e-12);
  }
}

TEST(Care, AgreesWithTheStableEigenvectorsOfTheHamiltonian) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const CareProblem problem = random_problem(seed);
    CareSolution solution;
    ASSERT_EQ(solve(problem, solution), CareOutcome::ok);
    const Dense expected = solution_by_eigenvectors(problem);
    EXPECT_LE((solution.S - expected).norm(), 1e-8 * expected.norm());
  }
}

/// Seven double integrators with weights as a walking robot has them: position and velocity weights over four
/// decades, cheap inputs. Inputs 0-6 drive one each.
CareProblem double_integrators() {
  CareProblem problem{StateMatrix::Zero(), InputMatrix::Zero(), StateMatrix::Zero(), InputWeight::Identity()};
  for (int i = 0; i < 7; ++i) {
    problem.A(i, 7 + i) = 1.0;
    problem.B(7 + i, i) = 1.0;
    problem.Q(i, i) = std::pow(4.0, i - 1);
    problem.Q(7 + i, 7 + i) = std::pow(3.0, 3 - i);
    problem.R(i, i) = i < 4 ? 2e-3 : 1e-3;
  }
  return problem;
}

TEST(Care, DoubleIntegratorsHaveTheirClosedFormSolution) {
  const CareProblem problem = double_integrators();
  expect_good(problem);
  CareSolution solution;
  ASSERT_EQ(solve(problem, solution), CareOutcome::ok);
  for (int i = 0; i < 7; ++i) {
    const double q = problem.Q(i, i), d = problem.Q(7 + i, 7 + i), r = problem.R(i, i);
    const double position = std::sqrt(q / r), velocity = std::sqrt(d / r + 2.0 * position);
    EXPECT_NEAR(solution.K(i, i), position, 1e-9 * position);
    EXPECT_NEAR(solution.K(i, 7 + i), velocity, 1e-9 * velocity);
  }
}

/// A is the first shift, the square root of the Hamiltonian's norm, on half of its diagonal: A - gamma I has
/// no inverse.
TEST(Care, AnEigenvalueAtTheFirstShiftIsNoObstacle) {
  constexpr double kEigenvalue = 6.0;
  constexpr int kHalf = kN / 2;
  CareProblem problem{-StateMatrix::Identity(), InputMatrix::Zero(), StateMatrix::Identity(),
                      InputWeight::Identity()};
  problem.A.diagonal().head<kHalf>().setConstant(kEigenvalue);
  const double rest = std::pow(kEigenvalue, 4) - 2.0 * problem.A.squaredNorm() - problem.Q.squaredNorm();
  ASSERT_GT(rest, 0.0);
  for (int i = 0; i < kHalf; ++i) problem.B(i, i) = std::pow(rest / kHalf, 0.25);
  expect_good(problem);
}

TEST(Care, AWeightWithoutWeightOnStableModesIsFine) {
  CareProblem problem = random_problem(11);
  problem.A.diagonal().array() -= 20.0;
  problem.Q.setZero();
  problem.Q(0, 0) = 1.0;
  expect_good(problem);
}

TEST(Care, CoupledInputWeightsAreRespected) {
  constexpr std::uint64_t kSeed = 12;
  SCOPED_TRACE(kSeed);
  CareProblem problem = random_problem(kSeed);
  std::mt19937_64 random(kSeed);
  const InputWeight root = gaussian<InputWeight>(random);
  problem.R = root.lazyProduct(root.transpose()) + InputWeight::Identity();
  problem.R = (0.5 * (problem.R + problem.R.transpose())).eval();
  expect_good(problem);
}

TEST(Care, AnUnstableModeOutOfReachIsReported) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CareProblem problem = random_problem(seed);
    problem.A.row(4).setZero();
    problem.A(4, 4) = 0.7;
    problem.B.row(4).setZero();
    CareSolution solution;
    EXPECT_EQ(solve(problem, solution), CareOutcome::no_stabilising_solution) << "seed " << seed;
  }
}

TEST(Care, AnIntegratorWithoutWeightIsReported) {
  CareProblem problem = double_integrators();
  problem.Q(2, 2) = 0.0;
  CareSolution solution;
  EXPECT_EQ(solve(problem, solution), CareOutcome::no_stabilising_solution);
}

TEST(Care, ImpossibleCostsAreRefused) {
  CareSolution solution;
  CareProblem problem = random_problem(1);
  problem.R(3, 3) = 0.0;
  EXPECT_EQ(solve(problem, solution), CareOutcome::bad_cost);
  problem = random_problem(1);
  problem.R(0, 1) = problem.R(1, 0) = 1e3;
  EXPECT_EQ(solve(problem, solution), CareOutcome::bad_cost);
  problem = random_problem(1);
  problem.Q(5, 5) = -1.0;
  EXPECT_EQ(solve(problem, solution), CareOutcome::bad_cost);
  problem = random_problem(1);
  problem.Q(5, 6) = 1.0;
  EXPECT_EQ(solve(problem, solution), CareOutcome::bad_cost);
}

/// Such a weight has pivots of either sign and about 1e-16: whether all are positive is chance.
TEST(Care, AnInputWeightThatLacksOneDirectionIsRefused) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    CareProblem problem = random_problem(seed);
    const Eigen::Matrix<double, kM, kM - 1> factor = gaussian<Eigen::Matrix<double, kM, kM - 1>>(random);
    problem.R = factor * factor.transpose();
    problem.R = (0.5 * (problem.R + problem.R.transpose())).eval();
    CareSolution solution;
    EXPECT_EQ(solve(problem, solution), CareOutcome::bad_cost);
  }
}

TEST(Care, NaNAndInfinityAreReported) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    CareSolution solution;
    CareProblem problem = random_problem(1);
    problem.A(3, 4) = bad;
    EXPECT_EQ(solve(problem, solution), CareOutcome::not_finite);
    problem = random_problem(1);
    problem.B(3, 4) = bad;
    EXPECT_EQ(solve(problem, solution), CareOutcome::not_finite);
    problem = random_problem(1);
    problem.Q(3, 3) = bad;
    EXPECT_EQ(solve(problem, solution), CareOutcome::not_finite);
    problem = random_problem(1);
    problem.R(3, 3) = bad;
    EXPECT_EQ(solve(problem, solution), CareOutcome::not_finite);
  }
}

}  // namespace
}  // namespace stilt::lq
