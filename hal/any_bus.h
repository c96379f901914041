#pragma once

#include <expected>
#include <memory>
#include <string>
#include <variant>

#include "hal/can/frame_bus.h"
#include "hal/can/socketcan/socketcan_bus.h"
#include "hal/loopback/loopback_client.h"

namespace stilt::hal {

/// A bus by its name: `loopback:NAME`, or an interface of the kernel (can0, vcan0). Nothing is ever chosen
/// silently.
class AnyBus {
 public:
  /// The error is one sentence for the user.
  [[nodiscard]] std::expected<void, std::string> open(const std::string& name,
                                                      const socketcan::BusOptions& options);

  /// After BusStatus::disconnected: call until true. Never waits, allocates nothing.
  [[nodiscard]] bool reconnect() noexcept;

  /// Valid after open.
  [[nodiscard]] FrameBus& frames() noexcept;
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  std::string name_;
  std::unique_ptr<std::variant<socketcan::SocketCanBus, loopback::LoopbackClient>> bus_;
};

}  // namespace stilt::hal
