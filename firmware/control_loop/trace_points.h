#pragma once

#include <sys/sdt.h>

#include <cstdint>

/// Static trace points (USDT) at the edges of tick and planner cycle, for perf and bpftrace: docs/tracing.md.
/// Each is one nop until a tracer attaches, calls nothing and allocates nothing: real-time safe. Why:
/// docs/decisions/0017-assertions-and-trace-points.md.
namespace stilt::control_loop::trace {

/// A tick begins. Times of the torque loop's clock.
inline void tick_begin(std::uint64_t tick, std::int64_t now_ns, std::int64_t wakeup_latency_ns) noexcept {
  STAP_PROBE3(stilt, tick_begin, tick, now_ns, wakeup_latency_ns);
}

/// The tick has sent its commands and left its record.
/// @param state           supervisor::State
/// @param fallback_level  supervisor::FallbackLevel
inline void tick_end(std::uint64_t tick, int state, int fallback_level) noexcept {
  STAP_PROBE3(stilt, tick_end, tick, state, fallback_level);
}

/// A solve begins.
/// @param tick  whose state the plan starts from
/// @param gait  gait::GaitKind that is asked for
inline void solve_begin(std::int64_t tick, int gait) noexcept { STAP_PROBE2(stilt, solve_begin, tick, gait); }

/// The solve has ended.
/// @param status  sqp::SolveStatus
inline void solve_end(std::int64_t tick, int status, int iterations) noexcept {
  STAP_PROBE3(stilt, solve_end, tick, status, iterations);
}

}  // namespace stilt::control_loop::trace
