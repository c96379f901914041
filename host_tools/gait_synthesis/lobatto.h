#pragma once

#include <Eigen/Core>

namespace stilt::gait_synthesis {

/// Polynomials of one degree n on [0, 1], by their values at the n + 1 Legendre-Gauss-Lobatto points.
struct LobattoBasis {
  Eigen::VectorXd node;             ///< [n + 1], from 0 to 1
  Eigen::VectorXd weight;           ///< [n + 1], quadrature over [0, 1], exact to degree 2 n - 1
  Eigen::MatrixXd differentiation;  ///< values at the nodes -> values of the derivative there
  /// Values at the nodes -> integrals of the polynomial from 0 to each node (Lobatto IIIA coefficients).
  Eigen::MatrixXd integration;
};

/// Basis of a degree of at least 2. Nodes are 0, 1 and the extrema of the Legendre polynomial P_n, by
/// Newton's method.
[[nodiscard]] LobattoBasis lobatto_basis(int degree);

/// Row r: the Bernstein polynomials of `degree` at the parameter s[r].
[[nodiscard]] Eigen::MatrixXd bernstein_matrix(const Eigen::VectorXd& s, int degree);

/// Row d: derivatives of order d, 0 to `orders`, of the Bernstein polynomials of `degree` at s. Row d times
/// the coefficients of a Bezier polynomial is its derivative of order d.
[[nodiscard]] Eigen::MatrixXd bernstein_derivatives(double s, int degree, int orders);

}  // namespace stilt::gait_synthesis
