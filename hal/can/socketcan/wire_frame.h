#pragma once

#include <linux/can.h>

#include <array>
#include <cstddef>
#include <span>

#include "hal/can/frame.h"

/// CanFrame <-> the structures of linux/can.h as read and written on a CAN_RAW socket: 16 bytes for a classic
/// frame, 72 for CAN FD. The loopback bus uses the same bytes. Real-time safe, without state.
namespace stilt::hal::socketcan {

inline constexpr std::size_t kClassicWireBytes = CAN_MTU;
inline constexpr std::size_t kFdWireBytes = CANFD_MTU;

using WireFrame = std::array<std::byte, kFdWireBytes>;

/// Writes the frame into the buffer; bytes to send, or 0 when no bus can carry it (well_formed).
[[nodiscard]] std::size_t to_wire(const CanFrame& frame, WireFrame& wire) noexcept;

/// Reads a frame. False when the size is neither of the two, or the contents cannot be a frame.
[[nodiscard]] bool from_wire(std::span<const std::byte> wire, CanFrame& frame) noexcept;

}  // namespace stilt::hal::socketcan
