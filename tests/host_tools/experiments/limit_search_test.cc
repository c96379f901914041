#include "host_tools/experiments/limit_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace stilt::experiments {
namespace {

constexpr LimitSearch kSearch = {0.1, 0.02, 0.5};

TEST(LimitSearch, FindsTheLimitToTheFineStep) {
  for (int first_failure = 1; first_failure <= 25; ++first_failure) {
    const Limit limit =
        find_limit(kSearch, [&](double value) { return std::lround(value / 0.02) < first_failure; });
    ASSERT_TRUE(limit.passed && limit.failed) << first_failure;
    EXPECT_NEAR(*limit.passed, 0.02 * (first_failure - 1), 1e-12);
    EXPECT_NEAR(*limit.failed, 0.02 * first_failure, 1e-12);
  }
}

TEST(LimitSearch, FindsNoLimitWhereZeroFails) {
  const Limit limit = find_limit(kSearch, [](double) { return false; });
  EXPECT_FALSE(limit.passed);
  EXPECT_EQ(limit.failed, 0.0);
}

TEST(LimitSearch, FindsNoFailureWhereTheLargestPassesAndTriesNothingBeyond) {
  std::vector<double> tried;
  const Limit limit = find_limit(kSearch, [&](double value) {
    tried.push_back(value);
    return true;
  });
  EXPECT_FALSE(limit.failed);
  ASSERT_EQ(tried.size(), 6u);
  for (std::size_t i = 0; i < tried.size(); ++i) EXPECT_NEAR(tried[i], 0.1 * static_cast<double>(i), 1e-12);
  EXPECT_NEAR(*limit.passed, 0.5, 1e-12);
}

TEST(LimitSearch, DoesNotSkipAFailureBelowLargerValuesThatPass) {
  const Limit limit = find_limit(kSearch, [](double value) { return std::lround(value / 0.1) != 2; });
  EXPECT_LT(*limit.passed, 0.2);
  EXPECT_GE(*limit.passed, 0.1);
}

TEST(LimitSearch, GoesDownWithNegativeSteps) {
  const Limit limit = find_limit({-0.1, -0.02, -0.5}, [](double value) { return value > -0.27; });
  EXPECT_NEAR(*limit.passed, -0.26, 1e-12);
  EXPECT_NEAR(*limit.failed, -0.28, 1e-12);
}

TEST(LimitSearch, TriesNoValueTwice) {
  std::set<long> tried;
  int trials = 0;
  (void)find_limit(kSearch, [&](double value) {
    ++trials;
    tried.insert(std::lround(value * 1e6));
    return value < 0.35;
  });
  EXPECT_EQ(static_cast<int>(tried.size()), trials);
}

}  // namespace
}  // namespace stilt::experiments
