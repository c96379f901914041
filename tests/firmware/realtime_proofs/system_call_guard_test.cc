#include "firmware/realtime/system_call_guard.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "firmware/realtime/thread.h"
#include "hal/robot/clock.h"

// Every guarded thread lives in a process of its own: a guard is never taken off.
namespace stilt::realtime {
namespace {

/// A guarded thread that does nothing else. Not a std::thread, whose end frees memory.
bool can_guard() {
  bool result = false;
  Thread thread;
  const bool started = thread.start(
      {"guarded"}, [](void* into) { *static_cast<bool*>(into) = forbid_other_system_calls(); }, &result);
  thread.join();
  return started && result;
}

/// Runs work on a guarded thread, then ends the process with 0.
[[noreturn]] void run_guarded(void (*work)(void*)) {
  struct Guarded {
    void (*work)(void*);
    static void run(void* self) {
      if (!forbid_other_system_calls()) std::_Exit(3);
      static_cast<Guarded*>(self)->work(nullptr);
    }
  } guarded{work};
  Thread thread;
  if (!thread.start({"guarded"}, &Guarded::run, &guarded)) std::_Exit(4);
  thread.join();
  std::_Exit(0);
}

class SystemCallGuard : public ::testing::Test {
 protected:
  void SetUp() override {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers use system calls of their own";
#endif
    if (!can_guard()) GTEST_SKIP() << "this kernel has no seccomp filters";
  }
};

TEST_F(SystemCallGuard, WhatARealTimeThreadNeedsPassesAndTheThreadEnds) {
  EXPECT_EXIT(run_guarded([](void*) {
                hal::MonotonicClock clock;
                static_cast<void>(clock.sleep_until(clock.now_ns() + 1000));
                rusage usage{};
                getrusage(RUSAGE_THREAD, &usage);
                mmsghdr message{};
                recvmmsg(-1, &message, 1, 0, nullptr);
                sendmmsg(-1, &message, 1, 0);
              }),
              ::testing::ExitedWithCode(0), "");
}

TEST_F(SystemCallGuard, OpeningAFileEndsTheProcess) {
  EXPECT_EXIT(run_guarded([](void*) { ::open("/dev/null", O_RDONLY); }), ::testing::KilledBySignal(SIGSYS),
              "");
}

TEST_F(SystemCallGuard, WritingAMessageEndsTheProcess) {
  EXPECT_EXIT(run_guarded([](void*) { static_cast<void>(!::write(2, "late", 4)); }),
              ::testing::KilledBySignal(SIGSYS), "");
}

TEST_F(SystemCallGuard, TakingMemoryFromTheKernelEndsTheProcess) {
  EXPECT_EXIT(run_guarded([](void*) {
                static_cast<void>(::mmap(nullptr, 1 << 20, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
              }),
              ::testing::KilledBySignal(SIGSYS), "");
}

TEST_F(SystemCallGuard, OtherThreadsStayFree) {
  EXPECT_EXIT(
      {
        if (!can_guard()) std::_Exit(3);
        std::_Exit(::open("/dev/null", O_RDONLY) >= 0 ? 0 : 5);
      },
      ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace stilt::realtime
