#pragma once

namespace stilt::gait {

inline constexpr int kMaxBezierDegree = 27;

/// Value of a polynomial with its first and second derivative by its parameter.
struct BezierPoint {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;
};

/// Evaluates the Bezier polynomial b(s) = sum_i C(n, i) s^i (1 - s)^(n - i) c_i with b'(s) and b''(s), by de
/// Casteljau's scheme. s is meant for [0, 1]; beyond, the polynomial continues. `coefficients`: degree + 1
/// numbers. `degree`: 0 to kMaxBezierDegree, clamped to that range. Real-time safe.
[[nodiscard]] inline BezierPoint evaluate_bezier(const double* coefficients, int degree, double s) noexcept {
  const int n = degree < 0 ? 0 : (degree > kMaxBezierDegree ? kMaxBezierDegree : degree);
  double b[kMaxBezierDegree + 1];
  for (int i = 0; i <= n; ++i) b[i] = coefficients[i];
  BezierPoint point;
  for (int left = n; left > 0; --left) {  // left + 1 points remain
    if (left == 2) point.curvature = n * (n - 1.0) * (b[2] - 2.0 * b[1] + b[0]);
    if (left == 1) point.slope = n * (b[1] - b[0]);
    for (int i = 0; i < left; ++i) b[i] += s * (b[i + 1] - b[i]);
  }
  point.value = b[0];
  return point;
}

/// The Bernstein polynomials of one degree at one parameter, shared by several Bezier polynomials of that
/// degree. Cheaper than evaluate_bezier() from the second polynomial on, and equal to it up to rounding.
/// Real-time safe.
class BernsteinBasis {
 public:
  /// `degree`: 0 to kMaxBezierDegree, clamped to that range.
  BernsteinBasis(int degree, double s) noexcept
      : degree_(degree < 0 ? 0 : (degree > kMaxBezierDegree ? kMaxBezierDegree : degree)) {
    fill(degree_, s, basis_);
    fill(degree_ - 1, s, slope_basis_);
    fill(degree_ - 2, s, curvature_basis_);
  }

  /// Value at s. `coefficients`: degree + 1 numbers.
  [[nodiscard]] double value(const double* coefficients) const noexcept {
    double sum = 0.0;
    for (int i = 0; i <= degree_; ++i) sum += basis_[i] * coefficients[i];
    return sum;
  }

  /// Value, first and second derivative at s.
  [[nodiscard]] BezierPoint evaluate(const double* coefficients) const noexcept {
    BezierPoint point;
    point.value = value(coefficients);
    const double* c = coefficients;
    for (int i = 0; i < degree_; ++i) point.slope += slope_basis_[i] * (c[i + 1] - c[i]);
    for (int i = 0; i + 1 < degree_; ++i) {
      point.curvature += curvature_basis_[i] * (c[i + 2] - 2.0 * c[i + 1] + c[i]);
    }
    point.slope *= degree_;
    point.curvature *= degree_ * (degree_ - 1.0);
    return point;
  }

 private:
  /// C(n, i) s^i (1 - s)^(n - i).
  static void fill(int n, double s, double* basis) noexcept {
    if (n < 0) return;
    double factor = 1.0;
    for (int i = 0; i <= n; ++i) {
      basis[i] = factor;
      factor *= s * (n - i) / (i + 1.0);
    }
    double rest = 1.0;
    for (int i = n; i >= 0; --i) {
      basis[i] *= rest;
      rest *= 1.0 - s;
    }
  }

  int degree_;
  double basis_[kMaxBezierDegree + 1];
  double slope_basis_[kMaxBezierDegree + 1];
  double curvature_basis_[kMaxBezierDegree + 1];
};

}  // namespace stilt::gait
