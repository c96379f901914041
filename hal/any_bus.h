#pragma once

#include <cstddef>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "hal/bus_lock.h"
#include "hal/can/fdcanusb/fdcanusb_bus.h"
#include "hal/can/frame_bus.h"
#include "hal/can/socketcan/socketcan_bus.h"
#include "hal/loopback/loopback_client.h"

namespace stilt::hal {

/// A bus by its name: `loopback:NAME`, `fdcanusb:PATH`, or an interface of the kernel (can0, vcan0). Nothing
/// is ever chosen silently.
class AnyBus {
 public:
  /// The error is one sentence for the user.
  /// @param priority  SCHED_FIFO of the thread that some buses have; 0: ordinary
  [[nodiscard]] std::expected<void, std::string> open(const std::string& name,
                                                      const socketcan::BusOptions& options, int priority = 0);

  /// Takes the right to command the drivers of the bus of that name, until this object ends; before open().
  /// The error is one sentence for the user.
  [[nodiscard]] std::expected<void, std::string> lock(const std::string& name);

  /// After BusStatus::disconnected: call until true. Never waits, allocates nothing.
  [[nodiscard]] bool reconnect() noexcept;

  /// Valid after open.
  [[nodiscard]] FrameBus& frames() noexcept;
  /// Commands that were handed over and that no node has acknowledged yet. An fdcanusb gives up what it
  /// repeats, after 50 ms: 0.
  [[nodiscard]] std::size_t unconfirmed() noexcept;
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  using Kinds = std::variant<socketcan::SocketCanBus, loopback::LoopbackClient, fdcanusb::FdcanusbBus>;

  std::string name_;
  std::optional<BusLock> lock_;
  std::unique_ptr<Kinds> bus_;
};

}  // namespace stilt::hal
