#pragma once

#include <cstdint>
#include <random>

#include "hal/can/frame.h"

namespace stilt::hal::testing {

/// Seeded source of test values; tests print seed() in their failures (SCOPED_TRACE).
class RandomValues {
 public:
  explicit RandomValues(std::uint64_t seed) : engine_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  std::uint32_t below(std::uint32_t end) { return static_cast<std::uint32_t>(engine_() % end); }
  bool chance(double probability) { return between(0, 1) < probability; }

  /// Any bytes, any flags, any length the kind allows and now and then one it does not.
  CanFrame frame() {
    CanFrame frame;
    frame.extended = chance(0.3);
    frame.remote = chance(0.05);
    frame.error = chance(0.05);
    frame.fd = chance(0.4);
    frame.bit_rate_switch = frame.fd && chance(0.5);
    frame.id = below(frame.extended ? kMaximumExtendedId + 1 : kMaximumStandardId + 1);
    frame.length = static_cast<std::uint8_t>(frame.fd ? fd_length(below(65)) : below(9));
    if (chance(0.02)) frame.length = static_cast<std::uint8_t>(below(256));
    for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(engine_());
    return frame;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace stilt::hal::testing
