#pragma once

#include <cstdint>

namespace stilt::hal {

/// What a torso sensor that is on no bus has measured last.
struct TorsoSample {
  double pitch_rad = 0;
  double pitch_rate_rad_s = 0;  ///< NaN: not measured
  std::int64_t time_ns = 0;     ///< of its arrival, CLOCK_MONOTONIC
  std::uint64_t number = 0;     ///< of samples so far; 0: none yet
  std::uint32_t malformed = 0;  ///< packets with a wrong checksum, since the start
};

/// Hands such samples to the torque loop.
class TorsoFeed {
 public:
  /// Wait-free, real-time safe.
  [[nodiscard]] virtual const TorsoSample& newest() noexcept = 0;

 protected:
  ~TorsoFeed() = default;
};

}  // namespace stilt::hal
