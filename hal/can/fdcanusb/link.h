#pragma once

#include <atomic>
#include <cstdint>

#include "hal/can/frame.h"
#include "hal/can/frame_bus.h"
#include "hal/exchange/ring.h"

namespace stilt::hal::fdcanusb {

/// A frame for the adapter.
struct Command {
  CanFrame frame;
  std::uint64_t sequence = 0;    ///< counts frames, from 1
  std::uint32_t connection = 0;  ///< that it was meant for
  std::int64_t time_ns = 0;      ///< when it was handed over
};

/// Between the torque loop and the thread of the serial port. Wait-free on both sides.
struct Link {
  exchange::Ring<Command, 64> commands;
  exchange::Ring<CanFrame, 256> arrivals;

  // Written by the thread of the port.
  std::atomic<std::uint32_t> connection{0};  ///< number of the one that works now; 0: none does
  std::atomic<std::uint64_t> settled{0};     ///< up to this sequence no frame waits in the adapter
  std::atomic<BusHealth> health{BusHealth::active};
  std::atomic<std::uint64_t> bus_off{0};
  std::atomic<std::uint64_t> error_reports{0};
  std::atomic<std::uint64_t> malformed{0};
  std::atomic<std::uint64_t> taken{0};  ///< frames that the adapter answered with OK
  std::atomic<std::uint64_t> answers_lost{0};
  std::atomic<std::uint64_t> stale{0};  ///< frames that waited here too long, and were dropped

  // Written by the torque loop.
  std::atomic<std::uint32_t> restarts{0};  ///< how often the CAN controller is to be restarted
};

}  // namespace stilt::hal::fdcanusb
