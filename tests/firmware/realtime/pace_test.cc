#include "firmware/realtime/pace.h"

#include <gtest/gtest.h>

namespace stilt::realtime {
namespace {

TEST(Pace, ATickInTimeIsFollowedByTheNext) {
  Pace pace(1000, 100);
  EXPECT_EQ(pace.advance(1000, 1050), 0);
  EXPECT_EQ(pace.next_ns(), 1100);
  EXPECT_EQ(pace.advance(1110, 1200), 0) << "done exactly when the next is due";
  EXPECT_EQ(pace.next_ns(), 1200);
}

TEST(Pace, AfterAnOverrunThePhaseStaysAndNothingIsCaughtUp) {
  Pace pace(1000, 100);
  EXPECT_EQ(pace.advance(1000, 1370), 3) << "1100, 1200 and 1300 are lost";
  EXPECT_EQ(pace.next_ns(), 1400);
  EXPECT_EQ(pace.advance(1400, 1450), 0);
  EXPECT_EQ(pace.next_ns(), 1500);
}

TEST(Pace, AShortOverrunLosesOnePeriod) {
  Pace pace(0, 1'000'000);
  EXPECT_EQ(pace.advance(10, 1'000'001), 1);
  EXPECT_EQ(pace.next_ns(), 2'000'000);
}

TEST(Pace, WhatBeginsMoreThanHalfAPeriodLateLeavesTheNextTimeOut) {
  Pace pace(1000, 100);
  EXPECT_EQ(pace.advance(1049, 1060), 0);
  EXPECT_EQ(pace.next_ns(), 1100);
  EXPECT_EQ(pace.advance(1190, 1195), 1) << "1200 would follow in a burst";
  EXPECT_EQ(pace.next_ns(), 1300);
  EXPECT_EQ(pace.advance(1580, 1585), 3) << "1400 and 1500 are over, 1600 is too near";
  EXPECT_EQ(pace.next_ns(), 1700);
}

TEST(Pace, WorkThatRestsTakesNineTenthsOfAProcessorAtMostHoweverLongItIs) {
  for (std::int64_t work_ns = 100; work_ns < 100'000; work_ns += 37) {
    Pace pace(0, 2000);
    std::int64_t began_ns = 0;
    for (int cycle = 0; cycle < 3; ++cycle) {
      began_ns = pace.next_ns();
      pace.advance(began_ns, rested_ns(began_ns, began_ns + work_ns));
      const auto period_ns = static_cast<double>(pace.next_ns() - began_ns);
      ASSERT_LE(static_cast<double>(work_ns) / period_ns, 0.9 + 1.0 / period_ns) << work_ns;
    }
  }
  Pace pace(0, 2000);
  EXPECT_EQ(pace.advance(0, rested_ns(0, 1800)), 0) << "nine tenths of the period";
  EXPECT_EQ(pace.next_ns(), 2000);
}

}  // namespace
}  // namespace stilt::realtime
