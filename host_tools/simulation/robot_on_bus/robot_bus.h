#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "hal/can/frame_bus.h"
#include "hal/can/socketcan/socketcan_bus.h"
#include "hal/loopback/loopback_server.h"

namespace stilt::robot_on_bus {

/// The robot's end of a bus by its name: `loopback:NAME`, which it listens on, or an interface of the kernel.
class RobotBus {
 public:
  /// @param fd  whether the wiring's drivers need CAN FD
  /// Throws std::invalid_argument, one sentence, when there is no such bus or its name is taken.
  RobotBus(const std::string& name, bool fd);

  [[nodiscard]] hal::FrameBus& frames();
  /// Whether a controller is connected. Always true for an interface of the kernel, which does not show it.
  [[nodiscard]] bool connected() const;
  /// Number of controllers that have connected, as far as the bus shows it.
  [[nodiscard]] std::uint64_t connections() const;
  /// For poll(): readable when a frame or a controller waits.
  [[nodiscard]] int descriptor() const;
  /// Ends the connection of a loopback bus; receive() accepts the next controller.
  void hang_up();
  [[nodiscard]] bool is_loopback() const;
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::unique_ptr<std::variant<hal::loopback::LoopbackServer, hal::socketcan::SocketCanBus>> bus_;
};

}  // namespace stilt::robot_on_bus
