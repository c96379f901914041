#pragma once

#include <cstdint>

namespace stilt::realtime {

/// Times of a periodic thread: start + k period. After an overrun the missed times are left out, the phase
/// stays, and no two periods follow each other in a burst. Pure.
class Pace {
 public:
  Pace(std::int64_t start_ns, std::int64_t period_ns) noexcept : next_ns_(start_ns), period_ns_(period_ns) {}

  [[nodiscard]] std::int64_t next_ns() const noexcept { return next_ns_; }

  /// The work of next_ns() is done at now_ns: moves on to the next time that is not over.
  /// @return  periods that were missed
  std::int64_t advance(std::int64_t now_ns) noexcept {
    next_ns_ += period_ns_;
    if (now_ns <= next_ns_) return 0;
    const std::int64_t missed = (now_ns - next_ns_ + period_ns_ - 1) / period_ns_;
    next_ns_ += missed * period_ns_;
    return missed;
  }

 private:
  std::int64_t next_ns_;
  std::int64_t period_ns_;
};

}  // namespace stilt::realtime
