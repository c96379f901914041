#include "host_tools/experiments/correlation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace stilt::experiments {
namespace {

TEST(Share, HasWilsonsIntervalAsNewcombePublishedIt) {
  // R. G. Newcombe, Statistics in Medicine 17 (1998), table I, method 3.
  struct Published {
    int successes, cases;
    double low, high;
  };
  for (const Published& one : {Published{81, 263, 0.2553, 0.3662}, Published{15, 148, 0.0624, 0.1605},
                               Published{0, 20, 0.0, 0.1611}, Published{1, 29, 0.0061, 0.1718}}) {
    const Estimate estimate = share(one.successes, one.cases);
    EXPECT_DOUBLE_EQ(estimate.value, static_cast<double>(one.successes) / one.cases);
    EXPECT_NEAR(estimate.interval.low, one.low, 5e-5);
    EXPECT_NEAR(estimate.interval.high, one.high, 5e-5);
  }
}

TEST(Share, OfAllCasesReachesOneAndMirrorsThatOfNone) {
  const Estimate all = share(500, 500), none = share(0, 500);
  EXPECT_NEAR(all.interval.high, 1.0, 1e-12);
  EXPECT_NEAR(none.interval.low, 0.0, 1e-12);
  EXPECT_NEAR(all.interval.low, 1.0 - none.interval.high, 1e-12);
}

TEST(Correlation, HasFishersInterval) {
  // x and y = x + k e with e orthogonal to x: r follows from k alone.
  std::vector<double> x, y;
  for (int i = 0; i < 28; ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0, error = i % 4 < 2 ? 1.0 : -1.0;
    x.push_back(3.0 + sign);
    y.push_back(7.0 - 2.0 * (sign + std::sqrt(3.0) * error));
  }
  const auto estimate = correlation(x, y);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->value, -0.5, 1e-12);
  // atanh(0.5) = 0.549306, standard error 1 / sqrt(25) = 0.2
  EXPECT_NEAR(estimate->interval.low, -std::tanh(0.549306 + 0.2 * 1.959964), 1e-6);
  EXPECT_NEAR(estimate->interval.high, -std::tanh(0.549306 - 0.2 * 1.959964), 1e-6);
}

TEST(Correlation, WithZerosAndOnesIsThePointBiserialFormula) {
  const std::vector<double> values = {1.0, 2.0, 4.0, 4.5, 7.0, 9.0, 9.5, 12.0};
  const std::vector<double> events = {0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0};
  // r = (M1 - M0) / s sqrt(p (1 - p)) with the standard deviation s of all values
  const double mean_with = (4.5 + 9.0 + 12.0) / 3.0, mean_without = (1.0 + 2.0 + 4.0 + 7.0 + 9.5) / 5.0;
  double mean = 0.0, squares = 0.0;
  for (const double value : values) mean += value / 8.0;
  for (const double value : values) squares += (value - mean) * (value - mean) / 8.0;
  const double expected = (mean_with - mean_without) / std::sqrt(squares) * std::sqrt(3.0 / 8.0 * 5.0 / 8.0);
  EXPECT_NEAR(correlation(values, events)->value, expected, 1e-12);
}

TEST(Correlation, IsUndefinedForAConstantOrAHandful) {
  const std::vector<double> constant(6, 2.0), other = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  EXPECT_FALSE(correlation(constant, other));
  EXPECT_FALSE(rank_correlation(other, constant));
  const std::vector<double> three = {1.0, 2.0, 3.0};
  EXPECT_FALSE(correlation(three, three));
}

TEST(RankCorrelation, IsThatOfTheTextbookAndSharesRanks) {
  // The example of en.wikipedia.org/wiki/Spearman's_rank_correlation_coefficient: rho = -29/165.
  const std::vector<double> iq = {106, 100, 86, 101, 99, 103, 97, 113, 112, 110};
  const std::vector<double> hours = {7, 27, 2, 50, 28, 29, 20, 12, 6, 17};
  const auto estimate = rank_correlation(iq, hours);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->value, -29.0 / 165.0, 1e-12);
  const double error = std::sqrt((1.0 + 0.5 * estimate->value * estimate->value) / 7.0);
  EXPECT_NEAR(estimate->interval.high, std::tanh(std::atanh(-29.0 / 165.0) + 1.959964 * error), 1e-6);
  // Ranks 1, 2.5, 2.5, 4 against 1, 2, 3, 4: r = 4.5 / sqrt(4.5 * 5).
  const std::vector<double> tied = {1.0, 5.0, 5.0, 8.0}, rising = {1.0, 2.0, 3.0, 4.0};
  EXPECT_NEAR(rank_correlation(tied, rising)->value, std::sqrt(0.9), 1e-12);
}

TEST(RankCorrelation, OfIndependentSamplesLeavesZeroOutOfOneIntervalInTwenty) {
  constexpr int kSamples = 2000;
  std::mt19937 random(20261);  // seed
  std::vector<double> x(40), y(40);
  int outside = 0;
  for (int sample = 0; sample < kSamples; ++sample) {
    for (double& value : x) value = static_cast<double>(random());
    for (double& value : y) value = static_cast<double>(random());
    const Interval interval = rank_correlation(x, y)->interval;
    if (interval.low > 0.0 || interval.high < 0.0) ++outside;
  }
  EXPECT_NEAR(outside, 0.05 * kSamples, 4.0 * std::sqrt(0.05 * 0.95 * kSamples));
}

}  // namespace
}  // namespace stilt::experiments
