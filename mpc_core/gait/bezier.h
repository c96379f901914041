#pragma once

namespace stilt::gait {

inline constexpr int kMaxBezierDegree = 27;

/// Value of a polynomial and its first and second derivative with respect to its parameter.
struct BezierPoint {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;
};

/// Bezier polynomial b(s) = sum_i C(n, i) s^i (1 - s)^(n - i) c_i at s (meant for [0, 1], a polynomial
/// beyond), with b'(s) and b''(s), by de Casteljau's scheme. `coefficients`: degree + 1 numbers;
/// degree: 0 to kMaxBezierDegree, values outside are clamped. Real-time safe.
[[nodiscard]] inline BezierPoint evaluate_bezier(const double* coefficients, int degree, double s) noexcept {
  const int n = degree < 0 ? 0 : (degree > kMaxBezierDegree ? kMaxBezierDegree : degree);
  double b[kMaxBezierDegree + 1];
  for (int i = 0; i <= n; ++i) b[i] = coefficients[i];
  BezierPoint point;
  for (int left = n; left > 0; --left) {  // left + 1 points are left
    if (left == 2) point.curvature = n * (n - 1.0) * (b[2] - 2.0 * b[1] + b[0]);
    if (left == 1) point.slope = n * (b[1] - b[0]);
    for (int i = 0; i < left; ++i) b[i] += s * (b[i + 1] - b[i]);
  }
  point.value = b[0];
  return point;
}

}  // namespace stilt::gait
