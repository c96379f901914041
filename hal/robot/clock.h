#pragma once

#include <cstdint>

namespace stilt::hal {

/// Time of the real-time loop. Mocked in tests; the mathematics never reads a clock.
class Clock {
 public:
  /// Nanoseconds since an arbitrary start, never backwards.
  [[nodiscard]] virtual std::int64_t now_ns() noexcept = 0;

  /// Sleeps until the given time; returns at once when it has passed. Returns the time after waking.
  [[nodiscard]] virtual std::int64_t sleep_until(std::int64_t time_ns) noexcept = 0;

 protected:
  ~Clock() = default;
};

/// CLOCK_MONOTONIC with absolute sleeps.
class MonotonicClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override;
  [[nodiscard]] std::int64_t sleep_until(std::int64_t time_ns) noexcept override;
};

}  // namespace stilt::hal
