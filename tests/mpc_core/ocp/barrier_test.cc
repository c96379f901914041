#include "mpc_core/ocp/barrier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace stilt::ocp {
namespace {

double barrier(const BarrierParameters& p, double h) {
  const BarrierConstants constants(p);
  BarrierSum sum(constants);
  sum.add(Batch(h));
  return sum.value()[0];
}

/// The second barrier of the pair is somewhere else and must not matter.
BarrierSlope slope(const BarrierParameters& p, double h) {
  return BarrierPair(BarrierCurve(p), Batch(h), Batch(1.7 * p.width)).a;
}

/// The formula of the header in the standard library's logarithm.
double baseline_barrier(const BarrierParameters& p, double h) {
  if (h > p.width) return -p.weight * std::log(h);
  return p.weight * (-std::log(p.width) + 0.5 * std::pow((h - 2.0 * p.width) / p.width, 2) - 0.5);
}

constexpr BarrierParameters kBarriers[] = {{0.2, 5.0}, {0.2, 3.0}, {0.05, 0.05}, {0.05, 0.5}, {100.0, 1e-3}};

TEST(Logarithm, AgreesWithTheStandardLibraryOverTheWholeRangeOfNormalNumbers) {
  constexpr std::uint64_t kSeed = 11;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> exponent(-1022.0, 1023.99);
  double worst = 0.0;
  for (int sample = 0; sample < 200000; ++sample) {
    const double x = std::max(std::exp2(exponent(random)), std::numeric_limits<double>::min());
    const double error = std::abs(logarithm(Batch(x))[0] - std::log(x)) / std::abs(std::log(x));
    worst = std::max(worst, error);
  }
  EXPECT_LT(worst, 4e-16) << "seed " << kSeed;
}

TEST(Logarithm, KeepsItsRelativeAccuracyNextToOne) {
  for (double offset = 0.49; offset > 1e-15; offset *= 0.93) {
    for (const double x : {1.0 + offset, 1.0 - offset}) {
      EXPECT_NEAR(logarithm(Batch(x))[0], std::log(x), 4e-16 * std::abs(std::log(x))) << "x " << x;
    }
  }
  EXPECT_EQ(logarithm(Batch(1.0))[0], 0.0);
}

TEST(Logarithm, IsRightAtTheEndsOfTheRangeAndOfTheMantissa) {
  for (const double x : {std::numeric_limits<double>::min(), std::numeric_limits<double>::max(), 2.0, 0.5,
                         std::nextafter(2.0, 0.0), std::sqrt(2.0), std::sqrt(0.5), 10.0}) {
    EXPECT_NEAR(logarithm(Batch(x))[0], std::log(x), 4e-16 * std::abs(std::log(x))) << "x " << x;
  }
}

TEST(Logarithm, TreatsEveryLaneOnItsOwn) {
  const Batch x([](auto lane) { return std::pow(10.0, 3.0 * static_cast<int>(lane) - 4.0); });
  const Batch result = logarithm(x);
  for (int lane = 0; lane < model::kLanes; ++lane) {
    EXPECT_NEAR(result[lane], std::log(x[lane]), 4e-16 * std::abs(std::log(x[lane])));
  }
}

TEST(Barrier, IsTheLogarithmAboveDeltaAndTheQuadraticBelow) {
  for (const BarrierParameters& p : kBarriers) {
    for (double h = -20.0 * p.width; h < 50.0 * p.width; h += 0.37 * p.width) {
      const double expected = baseline_barrier(p, h);
      EXPECT_NEAR(barrier(p, h), expected, 1e-13 * (p.weight + std::abs(expected)))
          << "width " << p.width << " h " << h;
    }
  }
}

TEST(Barrier, IsTwiceContinuouslyDifferentiableAtDelta) {
  for (const BarrierParameters& p : kBarriers) {
    const double above = p.width * (1.0 + 1e-12);
    EXPECT_NEAR(barrier(p, p.width), barrier(p, above), 1e-10 * p.weight);
    EXPECT_NEAR(slope(p, p.width).first[0], slope(p, above).first[0], 1e-10 * p.weight / p.width);
    EXPECT_NEAR(slope(p, p.width).second[0], slope(p, above).second[0],
                1e-10 * p.weight / (p.width * p.width));
  }
}

TEST(Barrier, SlopesAreTheDifferencesOfTheValue) {
  for (const BarrierParameters& p : kBarriers) {
    for (const double ratio : {-30.0, -1.0, 0.0, 0.3, 0.999, 1.001, 1.7, 12.0}) {
      const double h = ratio * p.width;
      const double step = 1e-5 * p.width;
      const double first = (barrier(p, h + step) - barrier(p, h - step)) / (2.0 * step);
      const double second = (slope(p, h + step).first[0] - slope(p, h - step).first[0]) / (2.0 * step);
      const double scale = p.weight / p.width * (1.0 + std::abs(ratio));
      EXPECT_NEAR(slope(p, h).first[0], first, 1e-8 * scale) << "h/width " << ratio;
      EXPECT_NEAR(slope(p, h).second[0], second, 1e-8 * scale / p.width) << "h/width " << ratio;
    }
  }
}

TEST(Barrier, DecreasesAndCurvesUpwardEverywhere) {
  for (const BarrierParameters& p : kBarriers) {
    for (double h = -100.0 * p.width; h < 100.0 * p.width; h += 0.73 * p.width) {
      EXPECT_LT(slope(p, h).first[0], 0.0);
      EXPECT_GT(slope(p, h).second[0], 0.0);
    }
  }
}

TEST(Barrier, SumOfSixteenIsTheSumOfEach) {
  constexpr std::uint64_t kSeed = 12;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> exponent(-3.0, 6.0);
  std::uniform_real_distribution<double> below(-50.0, 1.0);
  for (int sample = 0; sample < 1000; ++sample) {
    const BarrierParameters p = kBarriers[sample % 5];
    const BarrierConstants constants(p);
    BarrierSum sum(constants);
    double expected[model::kLanes] = {};
    double scale = 1.0;
    for (int term = 0; term < 16; ++term) {
      const Batch h([&](auto lane) {
        const bool inside = (sample + term + static_cast<int>(lane)) % 3 != 0;
        return p.width * (inside ? std::pow(10.0, exponent(random)) : below(random));
      });
      sum.add(h);
      for (int lane = 0; lane < model::kLanes; ++lane) {
        expected[lane] += baseline_barrier(p, h[lane]);
        scale += std::abs(baseline_barrier(p, h[lane]));
      }
    }
    const Batch value = sum.value();
    for (int lane = 0; lane < model::kLanes; ++lane) {
      ASSERT_NEAR(value[lane], expected[lane], 1e-13 * scale) << "seed " << kSeed << " sample " << sample;
    }
  }
}

TEST(Barrier, NotANumberStaysVisible) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(barrier(kBarriers[0], nan)));
  EXPECT_TRUE(std::isnan(slope(kBarriers[0], nan).first[0]));
}

}  // namespace
}  // namespace stilt::ocp
