#pragma once

#include <cstdint>

#include "firmware/telemetry/messages.h"

namespace stilt::telemetry {

/// How the torque loop's clock relates to the time of day: fixed at tick 0.
struct WallTime {
  std::int64_t start_clock_ns = 0;  ///< of tick 0, torque loop's clock
  std::int64_t start_time_ns = 0;   ///< the same moment, since 1970

  /// Seconds since tick 0.
  [[nodiscard]] double seconds(std::int64_t clock_ns) const noexcept {
    return 1e-9 * static_cast<double>(clock_ns - start_clock_ns);
  }
  [[nodiscard]] builtin_interfaces_msg_dds__Time_ stamp(std::int64_t clock_ns) const noexcept {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    const std::int64_t time_ns = start_time_ns + clock_ns - start_clock_ns;
    return {static_cast<std::int32_t>(time_ns / kSecond_ns),
            static_cast<std::uint32_t>(time_ns % kSecond_ns)};
  }
};

}  // namespace stilt::telemetry
