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
};

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
