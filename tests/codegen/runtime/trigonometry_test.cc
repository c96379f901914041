#include "codegen/runtime/trigonometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>

namespace stilt::runtime {
namespace {

namespace stdx = std::experimental;

/// Error of `value` against an exact result, in units in the last place of the exact result.
double error_ulp(double value, long double exact) {
  const double magnitude = std::abs(static_cast<double>(exact));
  const double ulp = std::nextafter(magnitude, std::numeric_limits<double>::max()) - magnitude;
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / ulp);
}

double worst_error_ulp(double angle) {
  double s = 0.0;
  double c = 0.0;
  sincos(angle, s, c);
  return std::max(error_ulp(s, std::sin(static_cast<long double>(angle))),
                  error_ulp(c, std::cos(static_cast<long double>(angle))));
}

TEST(TrigonometryTest, ErrorIsAtMostTwoUnitsInTheLastPlaceUpToTenThousandRadians) {
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (const double range : {0.01, 1.0, 10.0, 1e4}) {
    std::uniform_real_distribution<double> uniform(-range, range);
    double worst = 0.0;
    for (int i = 0; i < 250'000; ++i) worst = std::max(worst, worst_error_ulp(uniform(random)));
    EXPECT_LE(worst, 2.0) << "range " << range;
  }
}

TEST(TrigonometryTest, ErrorStaysSmallBesideMultiplesOfAQuarterTurn) {
  for (int n = -6000; n <= 6000; ++n) {
    const double nearest = n * (0.5 * std::numbers::pi);
    for (const double angle :
         {nearest, std::nextafter(nearest, 1e9), std::nextafter(nearest, -1e9), nearest + 1e-9}) {
      ASSERT_LE(worst_error_ulp(angle), 2.0) << "angle " << angle;
    }
  }
}

TEST(TrigonometryTest, WhatIsNoAngleGivesNotANumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double angle : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN(), 1e6, 1e300}) {
    double s = 0.0;
    double c = 0.0;
    sincos(angle, s, c);
    EXPECT_TRUE(std::isnan(s)) << angle;
    EXPECT_TRUE(std::isnan(c)) << angle;
  }
}

template <int kWidth>
void expect_lanes_equal_scalars() {
  using Batch = stdx::simd<double, stdx::simd_abi::deduce_t<double, kWidth>>;
  constexpr unsigned kSeed = 6;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed << " width " << kWidth);
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> uniform(-100.0, 100.0);
  for (int i = 0; i < 20'000; ++i) {
    const Batch angle([&](auto) { return uniform(random); });
    Batch s;
    Batch c;
    sincos(angle, s, c);
    for (int lane = 0; lane < kWidth; ++lane) {
      double scalar_s = 0.0;
      double scalar_c = 0.0;
      const double a = angle[static_cast<std::size_t>(lane)];
      sincos(a, scalar_s, scalar_c);
      const double lane_s = s[static_cast<std::size_t>(lane)];
      const double lane_c = c[static_cast<std::size_t>(lane)];
      ASSERT_EQ(std::bit_cast<std::uint64_t>(lane_s), std::bit_cast<std::uint64_t>(scalar_s))
          << "angle " << a;
      ASSERT_EQ(std::bit_cast<std::uint64_t>(lane_c), std::bit_cast<std::uint64_t>(scalar_c))
          << "angle " << a;
    }
  }
}

TEST(TrigonometryTest, EveryLaneOfABatchEqualsTheScalarToTheLastBit) {
  expect_lanes_equal_scalars<2>();
  expect_lanes_equal_scalars<stdx::native_simd<double>::size()>();
}

}  // namespace
}  // namespace stilt::runtime
