#include "hal/robot/clock.h"

#include <cerrno>
#include <ctime>

namespace stilt::hal {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

}  // namespace

std::int64_t MonotonicClock::now_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * kNanosecondsPerSecond + time.tv_nsec;
}

std::int64_t MonotonicClock::sleep_until(std::int64_t time_ns) noexcept {
  if (time_ns > 0) {
    timespec until{};
    until.tv_sec = time_ns / kNanosecondsPerSecond;
    until.tv_nsec = time_ns % kNanosecondsPerSecond;
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
  }
  return now_ns();
}

}  // namespace stilt::hal
