#pragma once

#include <span>
#include <string>
#include <vector>

#include "firmware/realtime/processor_state.h"

namespace stilt::realtime {

/// Threads of the kernel that a bus waits for.
struct BusInterrupts {
  std::string bus;                       ///< "can0"
  std::string adapter;                   ///< "spi0.0", "usb 1-1.2:1.0", "0000:03:00.0"; empty: no hardware
  std::vector<InterruptThread> threads;  ///< that serve it; none: not known, or the kernel has none
};

/// Adapters, as /sys describes them, and their threads. Those of a PCI device, also of a USB host on one, are
/// known by the number of the interrupt. Others are known by name: that of the bus, of the SPI device and its
/// controller, of a USB host. A USB adapter is also served by ksoftirqd, and threaded NAPI has a thread of
/// its own. `root`: where /proc and /sys are looked for, for tests.
[[nodiscard]] std::vector<BusInterrupts> bus_interrupts(std::span<const std::string> buses,
                                                        const std::string& root = "");

}  // namespace stilt::realtime
