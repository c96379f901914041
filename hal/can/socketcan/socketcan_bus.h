#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <vector>

#include "hal/can/socketcan/descriptor.h"
#include "hal/can/socketcan/frame_socket.h"

namespace stilt::hal::socketcan {

/// Filters and buffers of a socket.
struct BusOptions {
  /// Identifiers to receive. Must hold those we send too: the kernel filters echoes like other frames.
  /// Empty: everything.
  std::vector<FrameId> receive_ids;
  bool fd = false;                        ///< the interface must carry CAN FD frames
  int receive_buffer_bytes = 256 * 1024;  ///< room for housekeeping pauses; the kernel doubles it
  long bit_rate_bit_s = 1'000'000;        ///< that it must have, for the sentence where it is down
  long data_bit_rate_bit_s = 5'000'000;   ///< of CAN FD frames
};

/// Why an interface that is down is not opened, and the command that brings it up.
[[nodiscard]] std::string down_sentence(const std::string& interface, const BusOptions& options);
/// The same of one that carries no CAN FD frames.
[[nodiscard]] std::string classic_sentence(const std::string& interface, const BusOptions& options);

/// A CAN interface of the kernel (can0, vcan0) through one CAN_RAW socket. It has filters, error frames on
/// the same socket, echoes of own frames, the overflow counter of the receive queue. open() allocates and may
/// wait; frames() does neither.
class SocketCanBus {
 public:
  /// Opens an interface that is up. The error is one sentence for the user.
  [[nodiscard]] std::expected<void, std::string> open(const std::string& interface,
                                                      const BusOptions& options);

  /// Opens it again after it was down. False while it still is. Allocates nothing.
  [[nodiscard]] bool reopen() noexcept;

  [[nodiscard]] FrameSocket& frames() noexcept { return socket_; }
  [[nodiscard]] const FrameSocket& frames() const noexcept { return socket_; }

 private:
  Descriptor descriptor_;
  FrameSocket socket_{-1, Echo::kernel};
  std::string interface_;
  BusOptions options_;
  std::vector<can_filter> filters_;
};

}  // namespace stilt::hal::socketcan
