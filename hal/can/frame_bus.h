#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/can/frame.h"

namespace stilt::hal {

/// Most frames one call of send or receive moves.
inline constexpr std::size_t kMaximumBatch = 32;

/// How a send or receive ended.
enum class BusStatus : std::uint8_t {
  ok,            ///< everything asked for was done; of receive: nothing more waits
  more,          ///< receive only: the span is full and more frames may wait
  queue_full,    ///< send only: the transmit queue has no room (ENOBUFS, EAGAIN); the rest was dropped and
                 ///< counted
  unconfirmed,   ///< send only: at least one frame was withheld, its predecessor has not left yet
  malformed,     ///< a frame no bus can carry was dropped and counted
  disconnected,  ///< no bus: interface down, peer gone; nothing is sent or received
};

/// State of the controller of the bus, from its error frames.
enum class BusHealth : std::uint8_t {
  active,   ///< errors, if any, are below the warning level
  warning,  ///< many errors
  passive,  ///< so many that it may no longer flag them
  off,      ///< took itself off the bus. A fault that stays until clear_bus_off(), restart or not
};

/// Counts since the bus was opened. They only grow.
struct BusCounters {
  std::uint64_t sent = 0;              ///< frames handed to the kernel
  std::uint64_t received = 0;          ///< frames of other nodes
  std::uint64_t confirmed = 0;         ///< own frames seen on the bus (echo)
  std::uint64_t echoes_lost = 0;       ///< own frames whose echo was given up
  std::uint64_t dropped_full = 0;      ///< not sent: queue full
  std::uint64_t withheld = 0;          ///< not sent: predecessor with the same identifier unconfirmed
  std::uint64_t dropped_received = 0;  ///< lost by the kernel: our receive queue was full (SO_RXQ_OVFL)
  std::uint64_t malformed = 0;         ///< frames that cannot exist, either way
  std::uint64_t error_frames = 0;      ///< reports of the controller
  std::uint64_t bus_off = 0;           ///< how often the controller went off the bus
  std::uint64_t disconnections = 0;    ///< how often the bus went away
};

/// Result of FrameBus::send().
struct SendResult {
  std::size_t sent = 0;  ///< frames handed over
  BusStatus status = BusStatus::ok;
};

/// Result of FrameBus::receive().
struct ReceiveResult {
  std::size_t received = 0;  ///< frames written to the front of the span
  BusStatus status = BusStatus::ok;
};

/// One CAN bus. No call waits, allocates or locks; the owner calls from one thread. Error frames and echoes
/// of own frames are consumed inside and show in health() and counters().
class FrameBus {
 public:
  /// Sends up to kMaximumBatch frames in order; more are an error of the caller and stay unsent (queue_full).
  /// A frame is withheld while an earlier one with its identifier has not been seen on the bus. Commands
  /// queued for unpowered drivers can then not burst out when their power returns: one of each identifier
  /// may. It outlives this object in the controller of the bus (docs/hazards.md).
  [[nodiscard]] virtual SendResult send(std::span<const CanFrame> frames) noexcept = 0;

  /// Takes what has arrived, at most kMaximumBatch frames and at most the span.
  [[nodiscard]] virtual ReceiveResult receive(std::span<CanFrame> frames) noexcept = 0;

  [[nodiscard]] virtual BusHealth health() const noexcept = 0;
  /// A person resets faults: a bus that went off counts as on, and echoes that may be lost are given up.
  virtual void clear_bus_off() noexcept = 0;
  [[nodiscard]] virtual const BusCounters& counters() const noexcept = 0;

 protected:
  ~FrameBus() =
      default;  ///< never owned through the interface: the real-time code references no operator delete
};

}  // namespace stilt::hal
