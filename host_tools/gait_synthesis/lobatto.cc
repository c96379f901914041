#include "host_tools/gait_synthesis/lobatto.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace stilt::gait_synthesis {
namespace {

struct Legendre {
  double value;     ///< P_n
  double previous;  ///< P_{n-1}
};

Legendre legendre(int n, double x) {
  Legendre p{x, 1.0};
  for (int k = 2; k <= n; ++k) p = {((2.0 * k - 1.0) * x * p.value - (k - 1.0) * p.previous) / k, p.value};
  return p;
}

/// Point near `x` in [-1, 1] where (1 - x^2) P_n'(x) = n (P_{n-1} - x P_n) is zero.
double extremum(int n, double x) {
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Legendre p = legendre(n, x);
    const double move = (x * p.value - p.previous) / ((n + 1.0) * p.value);
    x -= move;
    if (std::abs(move) < 1e-16) break;
  }
  return x;
}

Eigen::MatrixXd differentiation_matrix(const Eigen::VectorXd& node) {
  const Eigen::Index count = node.size();
  Eigen::VectorXd barycentric = Eigen::VectorXd::Ones(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index k = 0; k < count; ++k) {
      if (k != i) barycentric[i] /= node[i] - node[k];
    }
  }
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index k = 0; k < count; ++k) {
      if (k == i) continue;
      d(i, k) = barycentric[k] / barycentric[i] / (node[i] - node[k]);
      d(i, i) -= d(i, k);  // the derivative of a constant is zero
    }
  }
  return d;
}

/// Exact for monomials up to the degree of the basis; well conditioned for the low degrees used.
Eigen::MatrixXd integration_matrix(const Eigen::VectorXd& node) {
  const Eigen::Index count = node.size();
  Eigen::MatrixXd power(count, count);
  Eigen::MatrixXd integral(count, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    power.col(c) = node.array().pow(static_cast<double>(c));
    integral.col(c) = node.array().pow(static_cast<double>(c + 1)) / static_cast<double>(c + 1);
  }
  return power.transpose().fullPivLu().solve(integral.transpose()).transpose();
}

}  // namespace

LobattoBasis lobatto_basis(int degree) {
  LobattoBasis basis{Eigen::VectorXd(degree + 1), Eigen::VectorXd(degree + 1), {}, {}};
  for (int i = 0; i <= degree; ++i) {
    const double x = extremum(degree, -std::cos(std::numbers::pi * i / degree));
    const double p = legendre(degree, x).value;
    basis.node[i] = 0.5 * (x + 1.0);
    basis.weight[i] = 1.0 / (degree * (degree + 1.0) * p * p);
  }
  basis.node[0] = 0.0;
  basis.node[degree] = 1.0;
  basis.differentiation = differentiation_matrix(basis.node);
  basis.integration = integration_matrix(basis.node);
  return basis;
}

Eigen::MatrixXd bernstein_matrix(const Eigen::VectorXd& s, int degree) {
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(s.size(), degree + 1);
  for (Eigen::Index r = 0; r < s.size(); ++r) {
    b(r, 0) = 1.0;
    for (int n = 1; n <= degree; ++n) {
      for (int i = n; i >= 0; --i) {
        b(r, i) = (i < n ? (1.0 - s[r]) * b(r, i) : 0.0) + (i > 0 ? s[r] * b(r, i - 1) : 0.0);
      }
    }
  }
  return b;
}

Eigen::MatrixXd bernstein_derivatives(double s, int degree, int orders) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(orders + 1, degree + 1);
  // Coefficients of the derivative of order d are differences of those before it, times its degree.
  Eigen::MatrixXd difference = Eigen::MatrixXd::Identity(degree + 1, degree + 1);
  for (int d = 0; d <= std::min(orders, degree); ++d) {
    const int left = degree - d;
    rows.row(d) = bernstein_matrix(Eigen::VectorXd::Constant(1, s), left) * difference.topRows(left + 1);
    for (int i = 0; i < left; ++i) difference.row(i) = left * (difference.row(i + 1) - difference.row(i));
  }
  return rows;
}

}  // namespace stilt::gait_synthesis
