#include "mpc_core/gait/bezier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace stilt::gait {
namespace {

double binomial(int n, int k) {
  double value = 1.0;
  for (int i = 0; i < k; ++i) value *= static_cast<double>(n - i) / (i + 1);
  return value;
}

/// Coefficients of degree n whose polynomial is s^power: C(i, power) / C(n, power).
std::vector<double> monomial(int n, int power) {
  std::vector<double> c;
  for (int i = 0; i <= n; ++i) c.push_back(i >= power ? binomial(i, power) / binomial(n, power) : 0.0);
  return c;
}

TEST(Bezier, OfAMonomialsCoefficientsIsTheMonomialWithItsDerivatives) {
  for (const int n : {3, 6, 12, kMaxBezierDegree}) {
    for (const int p : {0, 1, 2, 3}) {
      const std::vector<double> c = monomial(n, p);
      for (const double s : {0.0, 0.2, 0.5, 0.93, 1.0}) {
        const BezierPoint b = evaluate_bezier(c.data(), n, s);
        EXPECT_NEAR(b.value, std::pow(s, p), 1e-14);
        EXPECT_NEAR(b.slope, p > 0 ? p * std::pow(s, p - 1) : 0.0, 1e-12);
        EXPECT_NEAR(b.curvature, p > 1 ? p * (p - 1) * std::pow(s, p - 2) : 0.0, 1e-10);
      }
    }
  }
}

TEST(Bezier, PassesThroughItsFirstAndLastCoefficient) {
  const double c[] = {0.3, -1.0, 2.0, 0.7, -0.4};
  EXPECT_EQ(evaluate_bezier(c, 4, 0.0).value, 0.3);
  EXPECT_DOUBLE_EQ(evaluate_bezier(c, 4, 1.0).value, -0.4);
}

TEST(Bezier, OfDegreeZeroAndOneHasNoCurvature) {
  const double c[] = {2.0, 5.0};
  EXPECT_EQ(evaluate_bezier(c, 0, 0.7).value, 2.0);
  EXPECT_EQ(evaluate_bezier(c, 0, 0.7).slope, 0.0);
  const BezierPoint line = evaluate_bezier(c, 1, 0.5);
  EXPECT_EQ(line.value, 3.5);
  EXPECT_EQ(line.slope, 3.0);
  EXPECT_EQ(line.curvature, 0.0);
}

TEST(BernsteinBasis, GivesWhatDeCasteljauGivesAlsoBeyondTheEnds) {
  for (const int n : {0, 1, 2, 5, 14, kMaxBezierDegree}) {
    std::vector<double> c;
    for (int i = 0; i <= n; ++i) c.push_back(std::sin(1.7 * i + n));
    for (const double s : {-0.05, 0.0, 0.31, 0.5, 0.999, 1.0, 1.05}) {
      const BezierPoint wanted = evaluate_bezier(c.data(), n, s);
      const BernsteinBasis basis(n, s);
      const BezierPoint got = basis.evaluate(c.data());
      EXPECT_NEAR(got.value, wanted.value, 1e-12 * (1.0 + std::abs(wanted.value)));
      EXPECT_NEAR(got.slope, wanted.slope, 1e-11 * (1.0 + std::abs(wanted.slope)));
      EXPECT_NEAR(got.curvature, wanted.curvature, 1e-10 * (1.0 + std::abs(wanted.curvature)));
      EXPECT_EQ(basis.value(c.data()), got.value);
    }
  }
}

}  // namespace
}  // namespace stilt::gait
