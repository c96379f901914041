#include "firmware/commissioning/zero_phase.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stilt::commissioning {
namespace {

constexpr double kPeriod_s = 0.001;
constexpr double kCutoff_hz = 8.0;

std::vector<double> sine(double frequency_hz) {
  std::vector<double> samples;
  for (int i = 0; i < 4000; ++i) samples.push_back(std::sin(2 * M_PI * frequency_hz * kPeriod_s * i));
  return samples;
}

/// |H|^2 of a Butterworth filter of second order, 1 / (1 + (f / fc)^4): the gain of both passes.
TEST(ZeroPhase, HasTheGainOfButterworthSquaredAndNoDelay) {
  for (const double frequency_hz : {1.0, 4.0, 8.0, 16.0}) {
    const std::vector<double> samples = sine(frequency_hz);
    const std::vector<double> filtered = zero_phase_filtered(samples, kCutoff_hz, kPeriod_s);
    const double gain = 1 / (1 + std::pow(frequency_hz / kCutoff_hz, 4));
    for (std::size_t i = 1500; i < 2500; ++i)
      EXPECT_NEAR(filtered[i], gain * samples[i], 0.003) << frequency_hz;
  }
}

TEST(ZeroPhase, LeavesAConstantAlone) {
  for (const double value : zero_phase_filtered(std::vector<double>(100, 2.5), kCutoff_hz, kPeriod_s)) {
    EXPECT_NEAR(value, 2.5, 1e-12);
  }
  EXPECT_TRUE(zero_phase_filtered({}, kCutoff_hz, kPeriod_s).empty());
}

TEST(Derivative, IsThatOfASineWithoutDelay) {
  const std::vector<double> slopes = derivative(sine(2.0), kPeriod_s);
  for (std::size_t i = 1; i + 1 < slopes.size(); ++i) {
    EXPECT_NEAR(slopes[i], 4 * M_PI * std::cos(4 * M_PI * kPeriod_s * static_cast<double>(i)), 1e-3);
  }
}

}  // namespace
}  // namespace stilt::commissioning
