#pragma once

#include <cstdint>

namespace stilt::hal {

/// What came of decoding a frame. On anything but ok the output is untouched.
enum class DecodeStatus : std::uint8_t {
  ok,
  not_addressed,  ///< another identifier, or a kind of frame this message never has: not for this codec
  wrong_length,   ///< right identifier, wrong number of bytes
  malformed,      ///< inside the frame: counts, types or contents that contradict each other
  not_finite,     ///< a floating-point field that must be a number is NaN or infinite
};

/// What came of encoding a command. On not_finite, no_room and invalid the frame is untouched and must not be
/// sent.
enum class EncodeStatus : std::uint8_t {
  ok,
  saturated,   ///< encoded, with a value at the end of its range instead of beyond it
  not_finite,  ///< a value is NaN or infinite where the protocol has no word for unset
  no_room,     ///< does not fit into one frame
  invalid,     ///< identifiers or ranges of the driver make no sense
};

}  // namespace stilt::hal
