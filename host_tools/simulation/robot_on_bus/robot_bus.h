#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "hal/can/frame_bus.h"
#include "hal/can/socketcan/socketcan_bus.h"
#include "hal/loopback/loopback_server.h"

namespace stilt::robot_on_bus {

/// The robot's end of a bus by its name: `loopback:NAME`, where it listens, or an interface of the kernel.
class RobotBus {
 public:
  /// @param fd  the wiring's drivers need CAN FD
  /// Throws std::invalid_argument, one sentence, when there is no such bus or its name is taken.
  RobotBus(const std::string& name, bool fd);

  [[nodiscard]] hal::FrameBus& frames();
  /// Whether a controller is there; always true for an interface of the kernel.
  [[nodiscard]] bool connected() const;
  /// Controllers that came, as far as the bus knows.
  [[nodiscard]] std::uint64_t connections() const;
  /// For poll(): readable when a frame or a controller waits.
  [[nodiscard]] int descriptor() const;
  /// Ends the connection of a loopback bus; the next controller is let in by receive().
  void hang_up();
  [[nodiscard]] bool is_loopback() const;
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::unique_ptr<std::variant<hal::loopback::LoopbackServer, hal::socketcan::SocketCanBus>> bus_;
};

}  // namespace stilt::robot_on_bus
