#pragma once

#include <cstdint>

namespace stilt::hal {

/// How far a driver is in storing its present position as zero.
enum class ZeroProgress : std::uint8_t {
  none,    ///< the frame was no answer
  more,    ///< send the next frame
  done,    ///< it has answered the last one: its position is to be read back
  failed,  ///< it refuses
  unread,  ///< no answer that can be read: whether it has stored it is open
};

}  // namespace stilt::hal
