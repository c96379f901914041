#include "mpc_core/sqp/terminal_cost.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <memory>

#include "mpc_core/gait/reference.h"
#include "tests/mpc_core/ocp/planning_scene.h"
#include "tests/mpc_core/ocp/scalar_ocp.h"
#include "tests/robots.h"

namespace stilt::sqp {
namespace {

using model::kInputs;
using model::kStates;
using testing_support::StageVector;
using Matrix = Eigen::MatrixXd;

/// The terminal weight of a robot, and everything to check it with, derived once more.
struct Standing {
  ocp::ProblemData data;
  model::StateVector state;
  bool ok = false;
  Matrix A, B, Q, R, N;

  explicit Standing(const model::RobotModel& robot, double rho = 1.0, double base_x_weight = 5.0,
                    bool feet = false)
      : data(testing_support::default_data(robot)) {
    data.cost.terminal = rho;
    data.cost.terminal_feet = feet;
    data.cost.base_x = base_x_weight;
    ocp::set_weights(data);
    state = gait::standing_state(robot.constants,
                                 0.9 * (robot.constants.thigh_length_m + robot.constants.shin_length_m), 0.0,
                                 0.15, true);
    ok = set_terminal_cost(data, state, *std::make_unique<TerminalCostWorkspace>());

    const testing_support::ScalarOcp scalar(data);
    StageVector<double> z = StageVector<double>::Zero();
    z.head<kStates>() = state;
    for (const int fz : {5, 7}) z[kStates + fz] = 0.5 * robot.constants.total_mass_kg * model::kGravity_m_s2;
    const auto flow = [&](const StageVector<testing_support::Complex>& at) {
      return scalar.flow<testing_support::Complex>(at.head<kStates>(), at.data() + kStates);
    };
    const Matrix slopes = testing_support::jacobian(flow, z);
    A = slopes.leftCols<kStates>();
    B = slopes.rightCols<kInputs>();
    const Matrix whole = running_hessian(scalar, z, feet);
    Q = whole.topLeftCorner<kStates, kStates>();
    N = whole.topRightCorner<kStates, kInputs>();
    R = whole.bottomRightCorner<kInputs, kInputs>();
  }

  /// Gauss-Newton Hessian of the running cost's squares in flight, where no barrier of a force is among them.
  /// Squares come first: states and inputs, then the feet's positions, velocities and accelerations.
  [[nodiscard]] static Matrix running_hessian(const testing_support::ScalarOcp& scalar,
                                              const StageVector<double>& z, bool feet) {
    const gait::ReferencePoint reference{};
    const auto arguments = [&](const StageVector<testing_support::Complex>& at) {
      std::vector<testing_support::Complex> values;
      for (const auto& term : scalar.cost_terms({false, false}, reference, at)) {
        if (term.barrier == nullptr) values.push_back(term.y);
      }
      return values;
    };
    const Matrix rows = testing_support::jacobian(arguments, z);
    const auto terms = scalar.cost_terms({false, false}, reference, z);
    Matrix hessian = Matrix::Zero(kStates + kInputs, kStates + kInputs);
    for (Eigen::Index t = 0; t < (feet ? rows.rows() : kStates + kInputs); ++t) {
      hessian += terms[static_cast<std::size_t>(t)].second() * rows.row(t).transpose() * rows.row(t);
    }
    return hessian;
  }

  [[nodiscard]] Matrix weight() const {
    return Eigen::Map<const Eigen::Matrix<double, lq::kRows, kStates>>(&data.terminal_weight[0][0])
        .topRows<kStates>();
  }
};

class TerminalCost : public testing::TestWithParam<const model::RobotModel*> {};

TEST_P(TerminalCost, SolvesTheRiccatiEquationAtTheStandingPosture) {
  const Standing s(*GetParam());
  ASSERT_TRUE(s.ok);
  const Matrix S = s.weight();
  const Matrix SA = S * s.A;
  const Matrix SGS = S * s.B * s.R.inverse() * s.B.transpose() * S;
  const double scale = 2.0 * SA.norm() + SGS.norm() + s.Q.norm();
  EXPECT_LT((SA + SA.transpose() - SGS + s.Q).norm(), 1e-10 * scale);
}

TEST_P(TerminalCost, WithFeetSolvesTheRiccatiEquationOfTheWholeRunningCost) {
  const Standing s(*GetParam(), 1.0, 5.0, true);
  ASSERT_TRUE(s.ok);
  EXPECT_GT(s.N.norm(), 0.0);
  const Matrix S = s.weight();
  const Matrix SA = S * s.A;
  const Matrix SBN = S * s.B + s.N;
  const Matrix quadratic = SBN * s.R.inverse() * SBN.transpose();
  const double scale = 2.0 * SA.norm() + quadratic.norm() + s.Q.norm();
  EXPECT_LT((SA + SA.transpose() - quadratic + s.Q).norm(), 1e-10 * scale);
  const Matrix K = s.R.inverse() * SBN.transpose();
  EXPECT_LT(Matrix(s.A - s.B * K).eigenvalues().real().maxCoeff(), -1e-3);
}

TEST_P(TerminalCost, ItsFeedbackMakesTheStandingPostureStable) {
  const Standing s(*GetParam());
  const Matrix K = s.R.inverse() * s.B.transpose() * s.weight();
  EXPECT_GT(s.A.eigenvalues().real().maxCoeff(), -1e-9) << "without feedback it is not";
  EXPECT_LT(Matrix(s.A - s.B * K).eigenvalues().real().maxCoeff(), -1e-3);
}

TEST_P(TerminalCost, IsSymmetricPositiveDefiniteWithZeroPadding) {
  const Standing s(*GetParam());
  const Matrix S = s.weight();
  EXPECT_LT((S - S.transpose()).norm(), 1e-14 * S.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix>(S).eigenvalues().minCoeff(), 0.0);
  for (int c = 0; c < kStates; ++c) {
    for (int r = kStates; r < lq::kRows; ++r) EXPECT_EQ(s.data.terminal_weight[c][r], 0.0);
  }
}

TEST_P(TerminalCost, GrowsInProportionToRho) {
  const Matrix one = Standing(*GetParam(), 1.0).weight();
  const Matrix ten = Standing(*GetParam(), 10.0).weight();
  EXPECT_LT((ten - 10.0 * one).norm(), 1e-15 * ten.norm());
}

TEST_P(TerminalCost, IsZeroWithoutRho) {
  const Standing s(*GetParam(), 0.0);
  EXPECT_TRUE(s.ok);
  EXPECT_EQ(s.weight().norm(), 0.0);
}

TEST_P(TerminalCost, IsRefusedWhenTheWeightsLeaveTheBasePositionFree) {
  const Standing s(*GetParam(), 1.0, 0.0);
  EXPECT_FALSE(s.ok);
  EXPECT_EQ(s.weight().norm(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Robots, TerminalCost,
                         testing::Values(&testing_support::amber3m(), &testing_support::rabbit()),
                         [](const auto& instance) { return std::string(instance.param->constants.name); });

}  // namespace
}  // namespace stilt::sqp
