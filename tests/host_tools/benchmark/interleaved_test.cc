#include "host_tools/benchmark/interleaved.h"

#include <gtest/gtest.h>

namespace stilt::benchmark {
namespace {

TEST(Interleaved, KernelsTakeTurnsAndEachTurnRunsTwice) {
  std::vector<int> order;
  const std::vector<double> time_s =
      interleaved_medians_s({[&] { order.push_back(0); }, [&] { order.push_back(1); }}, 2);
  EXPECT_EQ(order, (std::vector<int>{0, 0, 1, 1, 0, 0, 1, 1}));
  ASSERT_EQ(time_s.size(), 2U);
  for (const double time : time_s) EXPECT_GE(time, 0.0);
}

TEST(Interleaved, TheMedianIsTheMiddleValue) {
  EXPECT_EQ(median({}), 0.0);
  EXPECT_EQ(median({3.0}), 3.0);
  EXPECT_EQ(median({9.0, 1.0, 5.0}), 5.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0);
}

}  // namespace
}  // namespace stilt::benchmark
