#include "host_tools/gait_synthesis/lobatto.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stilt::gait_synthesis {
namespace {

TEST(Lobatto, IntegratesPolynomialsUpToTwiceItsDegreeLessOne) {
  for (const int n : {2, 3, 4, 8, 19, 25}) {
    const LobattoBasis basis = lobatto_basis(n);
    for (int p = 0; p <= 2 * n - 1; ++p) {
      const double integral = basis.weight.dot(basis.node.array().pow(p).matrix());
      EXPECT_NEAR(integral, 1.0 / (p + 1.0), 1e-13) << "degree " << n << ", power " << p;
    }
    const double beyond = basis.weight.dot(basis.node.array().pow(2 * n).matrix());
    if (n <= 4) {
      EXPECT_GT(std::abs(beyond - 1.0 / (2.0 * n + 1.0)), 1e-8);
    }
  }
}

TEST(Lobatto, OfDegreeTwoIsHermiteSimpson) {
  const LobattoBasis basis = lobatto_basis(2);
  EXPECT_NEAR(basis.node[1], 0.5, 1e-15);
  EXPECT_NEAR(basis.weight[0], 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(basis.weight[1], 4.0 / 6.0, 1e-15);
  const Eigen::RowVector3d to_middle(5.0 / 24.0, 8.0 / 24.0, -1.0 / 24.0);
  EXPECT_LT((basis.integration.row(1) - to_middle).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Lobatto, DifferentiatesAndIntegratesPolynomialsOfItsDegreeExactly) {
  const int n = 5;
  const LobattoBasis basis = lobatto_basis(n);
  const Eigen::VectorXd fifth = basis.node.array().pow(5);
  const Eigen::VectorXd fourth = basis.node.array().pow(4);
  EXPECT_LT((basis.differentiation * fifth - 5.0 * fourth).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((basis.integration * (5.0 * fourth) - fifth).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Bernstein, RowsSumToOneAndAreTheirOwnDerivativesDifferences) {
  const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(7, 0.0, 1.0);
  const Eigen::MatrixXd rows = bernstein_matrix(s, 6);
  EXPECT_LT((rows.rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-14);
  constexpr double kMove = 1e-4;
  for (const double at : {0.2, 0.5, 0.8}) {
    const Eigen::MatrixXd here = bernstein_derivatives(at, 6, 4);
    const Eigen::MatrixXd ahead = bernstein_derivatives(at + kMove, 6, 4);
    const Eigen::MatrixXd behind = bernstein_derivatives(at - kMove, 6, 4);
    for (int order = 0; order < 4; ++order) {
      const Eigen::RowVectorXd slope = (ahead.row(order) - behind.row(order)) / (2.0 * kMove);
      const double size = 1.0 + here.row(order + 1).cwiseAbs().maxCoeff();
      EXPECT_LT((slope - here.row(order + 1)).cwiseAbs().maxCoeff(), 1e-5 * size);
    }
  }
}

}  // namespace
}  // namespace stilt::gait_synthesis
