#include "firmware/diagnostics/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "firmware/diagnostics/histogram_text.h"

namespace stilt::diagnostics {
namespace {

TEST(Histogram, EmptyGivesZeros) {
  const Percentiles p = Histogram().percentiles();
  EXPECT_EQ(p.p50_us, 0);
  EXPECT_EQ(p.p999_us, 0);
  EXPECT_EQ(p.max_us, 0);
}

TEST(Histogram, OneDurationIsEveryPercentile) {
  Histogram histogram;
  histogram.add_ns(123'456);
  const Percentiles p = histogram.percentiles();
  EXPECT_DOUBLE_EQ(p.p50_us, 123.456);
  EXPECT_DOUBLE_EQ(p.p99_us, 123.456);
  EXPECT_DOUBLE_EQ(p.max_us, 123.456);
  EXPECT_DOUBLE_EQ(histogram.percentile_us(0), 123.456);
}

TEST(Histogram, EveryDurationIsInTheBinBetweenItsEdges) {
  for (std::int64_t duration_ns = 0; duration_ns < 3'000'000'000; duration_ns += 1 + duration_ns / 57) {
    Histogram histogram;
    histogram.add_ns(duration_ns);
    std::size_t bin = 0;
    while (histogram.in_bin(bin) == 0) ++bin;
    const double duration_us = 1e-3 * static_cast<double>(duration_ns);
    ASSERT_LT(duration_us, Histogram::upper_edge_us(bin));
    ASSERT_TRUE(bin == 0 || duration_us >= Histogram::upper_edge_us(bin - 1)) << duration_us << " us";
  }
}

TEST(Histogram, EdgesRiseByAnEighthOrTheUnitAtMost) {
  const double unit_us = 1e-3 * static_cast<double>(Histogram::kUnit_ns);
  EXPECT_DOUBLE_EQ(Histogram::upper_edge_us(0), unit_us);
  for (std::size_t bin = 1; bin + 1 < Histogram::kBins; ++bin) {
    const double before = Histogram::upper_edge_us(bin - 1);
    const double width = Histogram::upper_edge_us(bin) - before;
    EXPECT_GT(width, 0);
    EXPECT_LE(width, std::max(unit_us, before / 8) * (1 + 1e-12)) << "bin " << bin;
  }
  EXPECT_GT(Histogram::upper_edge_us(Histogram::kBins - 2), 1e6) << "more than a second";
  EXPECT_TRUE(std::isinf(Histogram::upper_edge_us(Histogram::kBins - 1)));
}

TEST(Histogram, PercentilesAreNeverTooLowAndAnEighthTooHighAtMost) {
  constexpr unsigned kSeed = 4;
  std::mt19937 random(kSeed);
  std::lognormal_distribution<double> duration_us(3.0, 1.5);
  Histogram histogram;
  std::vector<double> sorted_us;
  for (int i = 0; i < 20'000; ++i) {
    const auto duration_ns = static_cast<std::int64_t>(1e3 * duration_us(random));
    histogram.add_ns(duration_ns);
    sorted_us.push_back(1e-3 * static_cast<double>(duration_ns));
  }
  std::sort(sorted_us.begin(), sorted_us.end());
  for (const double fraction : {0.01, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(sorted_us.size())));
    const double exact_us = sorted_us[rank - 1];
    EXPECT_GE(histogram.percentile_us(fraction), exact_us) << "seed " << kSeed;
    EXPECT_LE(histogram.percentile_us(fraction), exact_us * 1.125 + 0.064) << "seed " << kSeed;
  }
  EXPECT_DOUBLE_EQ(histogram.percentiles().max_us, sorted_us.back());
}

TEST(Histogram, TheLargestIsKeptExactlyBeyondTheLastEdge) {
  Histogram histogram;
  histogram.add_ns(10);
  histogram.add_ns(7'000'000'001);
  EXPECT_DOUBLE_EQ(histogram.percentiles().max_us, 7'000'000.001);
  EXPECT_DOUBLE_EQ(histogram.percentile_us(1), 7'000'000.001);
}

TEST(Histogram, ANegativeDurationIsCountedApart) {
  Histogram histogram;
  histogram.add_ns(-1);
  EXPECT_EQ(histogram.bad(), 1u);
  EXPECT_EQ(histogram.count(), 0u);
}

TEST(HistogramText, ShowsPercentilesAndOneLineABinInUse) {
  Histogram histogram;
  for (int i = 0; i < 99; ++i) histogram.add_ns(10'000);
  histogram.add_ns(2'000'000);
  EXPECT_EQ(to_text("wake-up", histogram),
            "wake-up: 100, p50 10.24 us, p99 10.24 us, p99.9 2000 us, max 2000 us\n"
            "  <       10.24 us         99 ##################################################\n"
            "  <        2097 us          1 #\n");
}

}  // namespace
}  // namespace stilt::diagnostics
