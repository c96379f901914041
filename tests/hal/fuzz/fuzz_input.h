#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "hal/can/frame.h"

namespace stilt::hal::fuzz {

/// A violated property ends the run, in libFuzzer as in the replay.
inline void check(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "property violated: %s\n", property);
  std::abort();
}

/// Reads an input from its front; an exhausted input gives zeros.
class Input {
 public:
  Input(const std::uint8_t* bytes, std::size_t size) : rest_(bytes, size) {}

  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t value = rest_.front();
    rest_ = rest_.subspan(1);
    return value;
  }
  std::uint16_t half() { return static_cast<std::uint16_t>(byte() | byte() << 8); }
  std::uint32_t word() { return half() | static_cast<std::uint32_t>(half()) << 16; }

  /// Flags, identifier, length and data. With the top flag the identifier is the expected one, and the length
  /// is what is left of the input.
  CanFrame frame(std::uint32_t expected_id) {
    CanFrame frame;
    const std::uint8_t flags = byte();
    frame.extended = (flags & 1) != 0;
    frame.remote = (flags & 2) != 0;
    frame.error = (flags & 4) != 0;
    frame.fd = (flags & 8) != 0;
    frame.bit_rate_switch = (flags & 16) != 0;
    frame.id = (flags & 0x80) != 0 ? expected_id : word();
    const std::size_t here = std::min(rest_.size(), frame.data.size());
    frame.length = (flags & 0x40) != 0 ? byte() : static_cast<std::uint8_t>(here);
    for (std::size_t i = 0; i < here; ++i) frame.data[i] = byte();
    return frame;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// The same bits, or both not a number.
inline bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace stilt::hal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);
