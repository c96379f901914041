#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hal/can/frame.h"

/// mjbots' fdcanusb (also mjcanfd-usb-1x): CAN FD over a USB serial port, as lines of text. Facts from the
/// vendor's firmware and its README, https://github.com/mjbots/fdcanusb, commit
/// f18c1d6a0c572768eeb9c6a05d01707f1964bfd3. The protocol has no checksums; USB has.
namespace stilt::hal::fdcanusb {

inline constexpr std::string_view kPrefix = "fdcanusb:";

/// `can send` with 64 bytes and an extended identifier, and some.
inline constexpr std::size_t kLongestCommand = 160;
using CommandText = std::array<char, kLongestCommand>;

/// The frame as a command to the adapter, with its newline. Real-time safe.
/// @return  characters; 0 for a frame that the protocol cannot carry: malformed, or without a data byte
[[nodiscard]] std::size_t write_command(const CanFrame& frame, CommandText& text) noexcept;

/// Answer to `can status`: registers of the adapter's CAN controller.
struct ControllerStatus {
  unsigned last_error = 0;       ///< lec: 0 none in the newest transfer, 7 no event since the last question
  unsigned last_data_error = 0;  ///< dlec: the same of the data phase
  bool warning = false;
  bool passive = false;
  bool off = false;

  /// Whether an attempt to send or receive has failed since the last question, without a later one that has
  /// not.
  [[nodiscard]] bool failing() const noexcept;
  /// Nothing was sent or received since the last question.
  [[nodiscard]] bool quiet() const noexcept;
};

/// What a line of the adapter means.
enum class LineKind : std::uint8_t {
  ok,         ///< a command was taken. For a frame: it is in a queue of the adapter, not on the bus yet
  refused,    ///< ERR: a command was refused
  not_on,     ///< ERR: the adapter is not in its state BusOn
  status,     ///< answer to `can status`
  received,   ///< a frame of another node; the adapter does not return its own
  malformed,  ///< nothing of these
};

/// A decoded line.
struct Line {
  LineKind kind = LineKind::malformed;
  CanFrame frame;           ///< of received
  ControllerStatus status;  ///< of status
};

/// A line from the adapter, without its end. Real-time safe.
[[nodiscard]] Line read_line(std::string_view text) noexcept;

}  // namespace stilt::hal::fdcanusb
