#include "firmware/commissioning/lag_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace stilt::commissioning {
namespace {

constexpr double kPeriod_s = 0.001;

double rocking(double time_s) { return 0.2 * std::sin(4 * time_s) + 0.05 * std::sin(9 * time_s); }

TEST(LagFit, FindsGainAndDelayOfANoisySignal) {
  for (const double delay_s : {-0.02, 0.0, 0.05}) {
    constexpr unsigned kSeed = 5;
    std::mt19937_64 random(kSeed);
    std::normal_distribution<double> noise(0, 0.002);
    std::vector<double> reference, signal;
    for (int i = 0; i < 4000; ++i) {
      const double time_s = kPeriod_s * i;
      reference.push_back(rocking(time_s) + noise(random));
      signal.push_back(-0.7 * rocking(time_s - delay_s) + 3.0 + noise(random));
    }
    const LagFit fit = fit_lag(reference, signal, kPeriod_s);
    EXPECT_NEAR(fit.gain, -0.7, 0.01) << "seed " << kSeed;
    EXPECT_NEAR(fit.delay_s, delay_s, 0.003) << "seed " << kSeed;
    EXPECT_GT(fit.explained, 0.99);
  }
}

TEST(LagFit, ASignalThatStandsStillExplainsNothing) {
  std::vector<double> reference;
  for (int i = 0; i < 1000; ++i) reference.push_back(rocking(kPeriod_s * i));
  const LagFit fit = fit_lag(reference, std::vector<double>(1000, 0.3), kPeriod_s);
  EXPECT_LT(fit.explained, 1e-9);
  EXPECT_LT(fit.signal_spread, 1e-9);
  EXPECT_GT(fit.reference_spread, 0.05);
}

TEST(LagFit, TooFewSamplesGiveNothing) {
  const std::vector<double> few(100, 1.0);
  EXPECT_EQ(fit_lag(few, few, kPeriod_s).explained, 0.0);
}

TEST(LagFit, WhatIsDetrendedHasNeitherMeanNorSlope) {
  std::vector<double> wave, drifting;
  for (int i = 0; i < 4000; ++i) {
    wave.push_back(rocking(kPeriod_s * i));
    drifting.push_back(wave.back() + 0.7 - 2.0 * kPeriod_s * i);
  }
  const std::vector<double> straight = detrended(wave), mended = detrended(drifting);
  for (std::size_t i = 0; i < wave.size(); ++i) EXPECT_NEAR(mended[i], straight[i], 1e-9);
  EXPECT_TRUE(detrended({}).empty());
  EXPECT_NEAR(spread(std::vector<double>{1.0, 3.0}), 1.0, 1e-12);
  EXPECT_EQ(spread({}), 0.0);
}

}  // namespace
}  // namespace stilt::commissioning
