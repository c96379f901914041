#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/can/fdcanusb/link.h"
#include "hal/can/frame_bus.h"
#include "hal/can/socketcan/frame_socket.h"

namespace stilt::hal::fdcanusb {

/// The torque loop's end of an adapter: frames go through rings of fixed memory, no call waits, allocates or
/// touches the port. A byte to a local socket wakes the thread that does.
///
/// A frame is withheld while an earlier one with its identifier may still be in the adapter (AdapterSession
/// says when it is not). Frames without data bytes are malformed here: the adapter has no command for them.
class LinkFrames final : public FrameBus {
 public:
  /// @param doorbell  descriptor of a datagram socket; -1: no thread is woken
  LinkFrames(Link& link, int doorbell, socketcan::SocketCalls calls = {}) noexcept
      : link_(link), doorbell_(doorbell), calls_(calls) {}

  [[nodiscard]] SendResult send(std::span<const CanFrame> frames) noexcept override;
  [[nodiscard]] ReceiveResult receive(std::span<CanFrame> frames) noexcept override;
  [[nodiscard]] BusHealth health() const noexcept override;
  void clear_bus_off() noexcept override;
  [[nodiscard]] const BusCounters& counters() const noexcept override { return counters_; }

  /// Takes the newest connection, if there is one. After BusStatus::disconnected: call until true.
  [[nodiscard]] bool reconnect() noexcept;

 private:
  /// The newest frame of an identifier.
  struct Sent {
    std::uint32_t key = 0;
    std::uint64_t sequence = 0;  ///< 0: none
    std::uint32_t refusals = 0;  ///< frames withheld since
  };
  static constexpr std::size_t kIdentifiers = 32;
  static constexpr std::uint32_t kMayBeLost = 6;  ///< refusals after which a reset gives a frame up

  [[nodiscard]] bool connected() noexcept;
  [[nodiscard]] BusStatus hand_over(const CanFrame& frame) noexcept;
  [[nodiscard]] Sent* place_of(std::uint32_t key) noexcept;
  [[nodiscard]] bool waits(const Sent& sent) const noexcept;
  void forget() noexcept { sent_.fill({}); }
  void ring() const noexcept;
  void count() noexcept;

  Link& link_;
  int doorbell_;
  socketcan::SocketCalls calls_;
  std::uint32_t connection_ = 0;  ///< 0: none
  std::uint64_t sequence_ = 0;
  std::uint64_t bus_off_seen_ = 0;
  std::uint64_t given_up_ = 0;
  std::uint64_t dropped_ = 0;    ///< found no room
  std::uint64_t malformed_ = 0;  ///< of this end's frames
  std::array<Sent, kIdentifiers> sent_{};
  BusCounters counters_;
};

}  // namespace stilt::hal::fdcanusb
