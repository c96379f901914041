#include "firmware/realtime/allocation_counter.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
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
  void* volatile larger = std::realloc(block, 20);
  EXPECT_EQ(scope.count(), 2);
  std::free(larger);
  EXPECT_EQ(scope.count(), 3) << "giving back counts too";
  block = std::calloc(2, 8);
  std::free(block);
  EXPECT_EQ(scope.count(), 5);
  block = std::aligned_alloc(64, 128);
  std::free(block);
  EXPECT_EQ(scope.count(), 7);
  void* aligned = nullptr;
  ASSERT_EQ(posix_memalign(&aligned, 64, 128), 0);
  std::free(aligned);
  EXPECT_EQ(scope.count(), 9);
  std::vector<double>* volatile vector = new std::vector<double>(100);
  EXPECT_EQ(scope.count(), 11);
  delete vector;
  EXPECT_EQ(scope.count(), 13);
  void* volatile nothing = nullptr;
  std::free(nothing);
  EXPECT_EQ(scope.count(), 13);
}

/// Uses the heap inside a scope, or outside, once that is the end; then ends with 0.
template <class Work>
[[noreturn]] void use_heap_in_a_proof(Work&& work) {
  end_on_heap_use();
  void* volatile outside = std::malloc(10);
  {
    const AllocationScope scope;
    work(outside);
  }
  std::free(outside);
  std::_Exit(0);
}

bool is_trap(int status) {
  return WIFSIGNALED(status) && (WTERMSIG(status) == SIGILL || WTERMSIG(status) == SIGTRAP);
}

TEST_F(AllocationCounter, InAProofTheFirstCallOfTheHeapEndsTheProcess) {
  EXPECT_EXIT(use_heap_in_a_proof([](void*) {}), testing::ExitedWithCode(0), "") << "outside it is free";
  EXPECT_EXIT(use_heap_in_a_proof([](void* block) {
                std::free(block);
                std::_Exit(1);
              }),
              is_trap, "");
  EXPECT_EXIT(use_heap_in_a_proof([](void*) {
                int* volatile number = new int;
                delete number;
                std::_Exit(1);
              }),
              is_trap, "");
  EXPECT_EXIT(use_heap_in_a_proof([](void* block) {
                static_cast<void>(!std::realloc(block, 100));
                std::_Exit(1);
              }),
              is_trap, "");
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
    EXPECT_EQ(scope.count(), 1);
    std::free(block);
    EXPECT_EQ(scope.count(), 2);
  });
  const AllocationScope scope;
  other.join();
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace stilt::realtime
