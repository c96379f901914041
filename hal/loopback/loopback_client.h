#pragma once

#include <expected>
#include <string>

#include "hal/can/socketcan/descriptor.h"
#include "hal/can/socketcan/frame_socket.h"
#include "hal/loopback/loopback_address.h"

namespace stilt::hal::loopback {

/// How an attempt to connect went.
enum class Connection : std::uint8_t {
  connected,
  waiting,            ///< connected, the greeting has not arrived yet
  no_listener,        ///< no program serves this name
  busy,               ///< another controller has the bus
  protocol_mismatch,  ///< the listener does not speak this protocol
};

/// The controller's end of a loopback bus.
class LoopbackClient {
 public:
  /// Connects, waiting at most this long for the greeting. The error is one sentence for the user.
  [[nodiscard]] std::expected<void, std::string> open(const std::string& name, int timeout_ms = 1000);

  /// Connects again after the robot restarted: call until it returns connected. Never waits, allocates
  /// nothing.
  [[nodiscard]] Connection reconnect() noexcept;

  [[nodiscard]] socketcan::FrameSocket& frames() noexcept { return socket_; }

 private:
  [[nodiscard]] Connection read_greeting() noexcept;

  std::string name_;
  socketcan::Descriptor descriptor_;
  bool greeted_ = false;
  socketcan::FrameSocket socket_{-1, socketcan::Echo::marked};
};

}  // namespace stilt::hal::loopback
