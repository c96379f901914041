#include "firmware/realtime/thread.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace stilt::realtime {
namespace {

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

/// Uses a good part of the stack and reports the page faults that took.
[[gnu::noinline]] void use_stack(void* faults) {
  const long before = page_faults();
  volatile char stack[256 * 1024];
  for (std::size_t i = 0; i < sizeof stack; i += 1024) stack[i] = 1;
  *static_cast<long*>(faults) = page_faults() - before + (stack[0] - 1);
}

TEST(Thread, TheStackIsInMemoryBeforeTheWorkBegins) {
  long faults = -1;
  Thread thread;
  ASSERT_TRUE(thread.start({.name = "test"}, use_stack, &faults));
  thread.join();
  EXPECT_EQ(faults, 0);
}

TEST(Thread, PriorityAndProcessorThatCannotBeHadAreLeftOutAndNamed) {
  bool ran = false;
  Thread thread;
  ASSERT_TRUE(thread.start(
      {.name = "test", .priority = 200, .core = 1000}, [](void* flag) { *static_cast<bool*>(flag) = true; },
      &ran));
  EXPECT_EQ(thread.refused(),
            "the thread of the test did not get SCHED_FIFO priority 200 and processor 1000");
  thread.join();
  EXPECT_TRUE(ran);
}

TEST(Thread, AProcessorBeyondAllIsNamedAndWhatWasNotAskedForIsNot) {
  const auto nothing = [](void*) {};
  Thread beyond, modest;
  ASSERT_TRUE(beyond.start({.name = "test", .core = 5000}, nothing, nullptr));
  EXPECT_EQ(beyond.refused(), "the thread of the test did not get processor 5000");
  ASSERT_TRUE(modest.start({.name = "test"}, nothing, nullptr));
  EXPECT_EQ(modest.refused(), "");
}

}  // namespace
}  // namespace stilt::realtime
