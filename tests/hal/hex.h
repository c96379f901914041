#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "hal/can/frame.h"

namespace stilt::hal::testing {

/// Payload of a frame as hexadecimal digits.
inline std::string hex(const CanFrame& frame) {
  std::string text;
  for (const std::uint8_t byte : frame.payload()) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    text += digits;
  }
  return text;
}

/// Sets payload and length from hexadecimal digits; spaces are skipped.
inline CanFrame with_payload(CanFrame frame, std::string_view digits) {
  frame.length = 0;
  int high = -1;
  for (const char digit : digits) {
    if (digit == ' ') continue;
    const int value = digit <= '9' ? digit - '0' : (digit | 0x20) - 'a' + 10;
    if (high < 0) {
      high = value;
    } else {
      frame.data[frame.length++] = static_cast<std::uint8_t>(high << 4 | value);
      high = -1;
    }
  }
  return frame;
}

}  // namespace stilt::hal::testing
