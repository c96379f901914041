#include "firmware/realtime/allocation_counter.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

namespace stilt::realtime {
namespace {

class AllocationCounter : public testing::Test {
 protected:
  void SetUp() override {
    if (!counts_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  }
};

TEST_F(AllocationCounter, EveryWayToTheHeapCounts) {
  const AllocationScope scope;
  void* volatile block = std::malloc(10);
  EXPECT_EQ(scope.count(), 1);
  block = std::realloc(block, 20);
  EXPECT_EQ(scope.count(), 2);
  std::free(block);
  block = std::calloc(2, 8);
  std::free(block);
  EXPECT_EQ(scope.count(), 3);
  block = std::aligned_alloc(64, 128);
  std::free(block);
  EXPECT_EQ(scope.count(), 4);
  std::vector<double>* volatile vector = new std::vector<double>(100);
  delete vector;
  EXPECT_EQ(scope.count(), 6);
}

TEST_F(AllocationCounter, WorkWithoutHeapCountsNothing) {
  const AllocationScope scope;
  volatile double sum = 0.0;
  for (int i = 0; i < 100; ++i) sum = sum + i;
  EXPECT_EQ(scope.count(), 0);
}

TEST_F(AllocationCounter, AnotherThreadCountsForItself) {
  std::thread other([] {
    const AllocationScope scope;
    void* volatile block = std::malloc(10);
    std::free(block);
    EXPECT_EQ(scope.count(), 1);
  });
  const AllocationScope scope;
  other.join();
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace stilt::realtime
