#include "hal/sensors/torso_measurement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stilt::hal {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;

void read(TorsoMeasurement& torso, std::int64_t time_ns, double pitch_rad) {
  torso.begin_read();
  torso.set_pitch(time_ns, pitch_rad);
  torso.end_read();
}

/// pitch = sin(w t) every millisecond. The rate of half a window ago is w cos(w (t - T/2)), but for the
/// curvature over the window, sinc(w T / 2).
TEST(TorsoMeasurement, ARateFromPitchesIsThatOfHalfAWindowAgo) {
  constexpr double kWindow_s = 0.01, kFrequency_rad_s = 9.0;
  TorsoMeasurement torso({.has_rate = false, .rate_window_s = kWindow_s});
  const double share = std::sin(kFrequency_rad_s * kWindow_s / 2) / (kFrequency_rad_s * kWindow_s / 2);
  for (int ms = 0; ms < 700; ++ms) {
    const double time_s = 1e-3 * ms;
    read(torso, kMillisecond_ns * (1 + ms), std::sin(kFrequency_rad_s * time_s));
    if (ms < 10) {
      EXPECT_TRUE(std::isnan(torso.reading().pitch_rate_rad_s)) << ms;
      continue;
    }
    const double expected_rad_s =
        share * kFrequency_rad_s * std::cos(kFrequency_rad_s * (time_s - kWindow_s / 2));
    EXPECT_NEAR(torso.reading().pitch_rate_rad_s, expected_rad_s, 1e-6) << ms;
  }
}

TEST(TorsoMeasurement, ARateFromPitchesBeginsAnewAfterAGap) {
  TorsoMeasurement torso({.has_rate = false, .rate_window_s = 0.01});
  for (int ms = 1; ms <= 30; ++ms) read(torso, kMillisecond_ns * ms, 0);
  EXPECT_EQ(torso.reading().pitch_rate_rad_s, 0);
  read(torso, kMillisecond_ns * 300, 0.5);
  EXPECT_TRUE(std::isnan(torso.reading().pitch_rate_rad_s)) << "not 0.5 rad over 270 ms";
  for (int ms = 301; ms <= 310; ++ms) read(torso, kMillisecond_ns * ms, 0.5 + 1e-3 * (ms - 300));
  EXPECT_NEAR(torso.reading().pitch_rate_rad_s, 1.0, 1e-9);
}

/// pitch = a t^2 / 2, so that a rate of T ago differs by a T from the rate of now. A gap of G >= T and a time
/// s after it share a window. Its rate is late by ((T - s) (s + G / 2) + s^2 / 2) / T, at most G / 2 + T / 8.
TEST(TorsoMeasurement, AfterAShortGapTheFirstRateIsTheMeanOfTheGapAndAWindowLaterAllIsAsBefore) {
  constexpr double kAcceleration_rad_s2 = 3.0, kWindow_ms = 10;
  const auto pitch_rad = [](int ms) { return kAcceleration_rad_s2 / 2 * 1e-6 * ms * ms; };
  for (const int gap_ms : {10, 11, 14, 19, 35, 50}) {
    TorsoMeasurement torso({.has_rate = false, .rate_window_s = 0.01});
    const auto late_ms = [&torso](int ms) {
      return ms - 1e3 * torso.reading().pitch_rate_rad_s / kAcceleration_rad_s2;
    };
    for (int ms = 1; ms <= 100; ++ms) read(torso, kMillisecond_ns * ms, pitch_rad(ms));
    EXPECT_NEAR(late_ms(100), 5, 1e-9);
    const int first_ms = 100 + gap_ms;
    read(torso, kMillisecond_ns * first_ms, pitch_rad(first_ms));
    EXPECT_NEAR(late_ms(first_ms), gap_ms / 2.0, 1e-9) << gap_ms;
    for (int ms = first_ms + 1; ms <= first_ms + 20; ++ms) {
      read(torso, kMillisecond_ns * ms, pitch_rad(ms));
      ASSERT_TRUE(std::isfinite(torso.reading().pitch_rate_rad_s)) << gap_ms << ' ' << ms;
      EXPECT_LT(late_ms(ms), gap_ms / 2.0 + kWindow_ms / 8) << gap_ms << ' ' << ms;
      if (ms >= first_ms + 10) {
        EXPECT_NEAR(late_ms(ms), 5, 1e-9) << gap_ms << ' ' << ms;
      }
    }
  }
}

/// The share of the gap in the window goes down from sample to sample: nothing jumps.
TEST(TorsoMeasurement, ARateAfterAShortGapGoesOverToTheNewPitches) {
  TorsoMeasurement torso({.has_rate = false, .rate_window_s = 0.01});
  for (int ms = 1; ms <= 30; ++ms) read(torso, kMillisecond_ns * ms, 0);
  const double step_rad = 0.02;  // within the gap of 20 ms, and at rest from then on
  for (int ms = 50; ms <= 61; ++ms) {
    read(torso, kMillisecond_ns * ms, step_rad);
    const double in_gap_ms = std::max(0.0, 9.75 - (ms - 50));  // a window without its jitter
    EXPECT_NEAR(torso.reading().pitch_rate_rad_s, in_gap_ms / 9.75, 1e-9) << ms;
  }
}

TEST(TorsoMeasurement, ASecondShortGapBeginsWhereTheFirstEnded) {
  TorsoMeasurement torso({.has_rate = false, .rate_window_s = 0.01});
  for (int ms = 1; ms <= 30; ++ms) read(torso, kMillisecond_ns * ms, 0);
  read(torso, kMillisecond_ns * 45, 0.015);
  EXPECT_NEAR(torso.reading().pitch_rate_rad_s, 1.0, 1e-9);
  read(torso, kMillisecond_ns * 60, 0.045);
  EXPECT_NEAR(torso.reading().pitch_rate_rad_s, 2.0, 1e-9);
}

TEST(TorsoMeasurement, AGapOfMoreThanFiftyMillisecondsIsTooLongForARate) {
  for (const int gap_ms : {50, 51}) {
    TorsoMeasurement torso({.has_rate = false, .rate_window_s = 0.01});
    for (int ms = 1; ms <= 30; ++ms) read(torso, kMillisecond_ns * ms, 0);
    read(torso, kMillisecond_ns * (30 + gap_ms), 0.01);
    EXPECT_EQ(std::isfinite(torso.reading().pitch_rate_rad_s), gap_ms == 50) << gap_ms;
  }
}

TEST(TorsoMeasurement, TheLongestWindowFitsAtOneKilohertz) {
  TorsoMeasurement torso({.has_rate = false, .rate_window_s = 0.05});
  for (int ms = 1; ms <= 200; ++ms) read(torso, kMillisecond_ns * ms, 2e-3 * ms);
  EXPECT_NEAR(torso.reading().pitch_rate_rad_s, 2.0, 1e-9);
}

TEST(TorsoMeasurement, APitchThatRepeatsIsUnwrappedFromUprightOn) {
  constexpr double kTurn_rad = 2 * std::numbers::pi;
  TorsoMeasurement torso({.pitch_period_rad = kTurn_rad});
  read(torso, 1, kTurn_rad - 0.1);
  EXPECT_NEAR(torso.reading().pitch_rad, -0.1, 1e-12);
  double true_rad = -0.1;
  for (int i = 0; i < 1000; ++i) {  // three turns forward
    true_rad += 0.019;
    read(torso, 2 + i, std::fmod(true_rad + 10 * kTurn_rad, kTurn_rad));
    ASSERT_NEAR(torso.reading().pitch_rad, true_rad, 1e-9) << i;
  }
}

TEST(TorsoMeasurement, PitchAndRateAgeApart) {
  TorsoMeasurement torso({.period_reads = 2});
  const auto step = [&torso](bool pitch, bool rate) {
    torso.begin_read();
    if (rate) torso.set_rate(0.1);
    if (pitch) torso.set_pitch(1, 0.2);
    torso.end_read();
    return torso.reading().missed_replies;
  };
  EXPECT_EQ(step(true, true), 0u);
  EXPECT_EQ(step(false, false), 0u) << "not due yet";
  EXPECT_EQ(step(true, false), 1u) << "the rate was due";
  EXPECT_EQ(step(true, false), 2u);
  EXPECT_EQ(step(false, true), 0u) << "the pitch is due with the next read";
  EXPECT_EQ(step(false, true), 1u);
  EXPECT_EQ(step(false, true), 2u);
  EXPECT_EQ(step(true, true), 0u);
}

TEST(TorsoMeasurement, WithoutARateOfItsOwnOnlyThePitchAges) {
  TorsoMeasurement torso({.has_rate = false});
  for (int i = 1; i < 50; ++i) {
    read(torso, kMillisecond_ns * i, 0.01 * i);
    EXPECT_EQ(torso.reading().missed_replies, 0u);
  }
}

TEST(TorsoMeasurement, OnlyAnEqualPitchWithAnEqualRateIsARepetition) {
  TorsoMeasurement torso({.period_reads = 2});
  const auto unchanged = [&torso](double pitch_rad, double rate_rad_s) {
    torso.begin_read();
    torso.set_rate(rate_rad_s);
    torso.set_pitch(1, pitch_rad);
    torso.end_read();
    return torso.reading().unchanged_replies;
  };
  EXPECT_EQ(unchanged(0.1, 1), 0u);
  EXPECT_EQ(unchanged(0.1, 1), 2u) << "counted in reads";
  EXPECT_EQ(unchanged(0.1, 2), 0u);
  EXPECT_EQ(unchanged(0.2, 2), 0u);
}

}  // namespace
}  // namespace stilt::hal
