#pragma once

#include <cstdint>

namespace stilt::realtime {

/// Times of a periodic thread: start + k period. After an overrun the missed times are left out, the phase
/// stays, and no two periods follow each other in a burst. What begins more than half a period late leaves
/// the next time out, too, since the other end needs a moment to answer. Pure.
class Pace {
 public:
  Pace(std::int64_t start_ns, std::int64_t period_ns) noexcept : next_ns_(start_ns), period_ns_(period_ns) {}

  [[nodiscard]] std::int64_t next_ns() const noexcept { return next_ns_; }

  /// The work of next_ns() began and is done: moves on to the next time that is not over.
  /// @return  periods that were missed
  std::int64_t advance(std::int64_t began_ns, std::int64_t done_ns) noexcept {
    std::int64_t missed = 0;
    next_ns_ += period_ns_;
    if (done_ns > next_ns_) missed = (done_ns - next_ns_ + period_ns_ - 1) / period_ns_;
    if (next_ns_ + missed * period_ns_ - began_ns < period_ns_ / 2) ++missed;
    next_ns_ += missed * period_ns_;
    return missed;
  }

 private:
  std::int64_t next_ns_;
  std::int64_t period_ns_;
};

/// End of some work with a rest of a ninth of it: a thread that rests leaves a tenth of its processor. Where
/// real-time threads take 95 % of one (sched_rt_runtime_us), the kernel stops all of them there for a while.
[[nodiscard]] constexpr std::int64_t rested_ns(std::int64_t began_ns, std::int64_t done_ns) noexcept {
  return done_ns + (done_ns - began_ns) / 9;
}

}  // namespace stilt::realtime
