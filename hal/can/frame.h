#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

namespace stilt::hal {

inline constexpr std::size_t kMaximumFrameBytes = 64;  ///< data bytes of the longest CAN FD frame
inline constexpr std::size_t kClassicFrameBytes = 8;   ///< data bytes of the longest classic frame
inline constexpr std::uint32_t kMaximumStandardId = 0x7ff;
inline constexpr std::uint32_t kMaximumExtendedId = 0x1fffffff;

/// One frame of a CAN or CAN FD bus, as the codecs and buses exchange it. Plain data, real-time safe.
struct CanFrame {
  std::uint32_t id = 0;          ///< 11 bits, or 29 when extended; of an error frame: its error classes
  std::uint8_t length = 0;       ///< data bytes: 0 to 8, or one of 12, 16, 20, 24, 32, 48, 64 with fd
  bool extended = false;         ///< identifier has 29 bits
  bool remote = false;           ///< asks for data instead of carrying it (classic only)
  bool fd = false;               ///< CAN FD
  bool bit_rate_switch = false;  ///< FD: data phase at the faster bit rate
  bool error = false;  ///< not a frame of the bus but a report of the controller (linux/can/error.h)
  std::array<std::uint8_t, kMaximumFrameBytes> data{};

  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept {
    return std::span(data).first(length <= data.size() ? length : data.size());
  }
  friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

/// Identifier of a CAN frame.
struct FrameId {
  std::uint32_t id = 0;
  bool extended = false;  ///< 29 bits instead of 11
};

/// Of a driver's reply to a command. Where drivers share it, bits of its first byte name the driver.
struct ReplyId : FrameId {
  std::uint8_t sender_mask = 0;
  std::uint8_t sender = 0;
};

/// The standard identifiers whose bits under `mask` are those of `value`; mask 0: none.
struct StandardIds {
  std::uint32_t value = 0;
  std::uint32_t mask = 0;
};

/// Those of a driver, as many as the driver with most has.
using DriverStandardIds = std::array<StandardIds, 3>;

/// Smallest length a CAN FD frame can have for this many bytes; 0 when none holds them (more than 64).
[[nodiscard]] constexpr std::uint8_t fd_length(std::size_t bytes) noexcept {
  if (bytes <= kClassicFrameBytes) return static_cast<std::uint8_t>(bytes);
  for (const unsigned length : {12u, 16u, 20u, 24u, 32u, 48u, 64u}) {
    if (bytes <= length) return static_cast<std::uint8_t>(length);
  }
  return 0;
}

/// Whether the frame can exist on a bus: identifier in range, a length its kind allows, flags consistent.
[[nodiscard]] constexpr bool well_formed(const CanFrame& frame) noexcept {
  if (frame.id > (frame.extended || frame.error ? kMaximumExtendedId : kMaximumStandardId)) return false;
  if (frame.fd) return !frame.remote && !frame.error && fd_length(frame.length) == frame.length;
  return frame.length <= kClassicFrameBytes && !frame.bit_rate_switch;
}

/// A classic data frame with a standard identifier and this many zero bytes.
[[nodiscard]] constexpr CanFrame classic_frame(std::uint32_t id, std::uint8_t length) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.length = length;
  return frame;
}

}  // namespace stilt::hal
