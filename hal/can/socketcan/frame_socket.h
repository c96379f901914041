#pragma once

#include <sys/socket.h>
#include <sys/uio.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/can/frame_bus.h"
#include "hal/can/socketcan/confirmations.h"
#include "hal/can/socketcan/wire_frame.h"

namespace stilt::hal::socketcan {

/// The two calls of the kernel, replaceable in tests.
struct SocketCalls {
  int (*receive_many)(int, mmsghdr*, unsigned, int, timespec*) = ::recvmmsg;
  int (*send_many)(int, mmsghdr*, unsigned, int) = ::sendmmsg;
};

/// How own frames come back.
enum class Echo : std::uint8_t {
  none,    ///< they do not: nothing is withheld
  kernel,  ///< CAN_RAW_RECV_OWN_MSGS: received with MSG_CONFIRM
  marked,  ///< loopback: the peer returns each frame with a mark in a byte the kernel leaves unused
};

/// Batch I/O over a descriptor that delivers whole frames: a CAN_RAW socket, or a Unix SOCK_SEQPACKET one
/// with the same bytes. Never waits. Buffers live in the object; nothing is allocated. Does not own the
/// descriptor.
class FrameSocket final : public FrameBus {
 public:
  explicit FrameSocket(int descriptor = -1, Echo echo = Echo::none, SocketCalls calls = {}) noexcept
      : descriptor_(descriptor), echo_(echo), calls_(calls) {}

  /// Another descriptor (after a reconnection); counters stay.
  void reset(int descriptor) noexcept;
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] bool connected() const noexcept { return descriptor_ >= 0 && !gone_; }

  /// ENOBUFS and a full socket drop the rest of the batch and are counted, never fatal: the next tick has
  /// newer commands. A vanished interface or peer gives disconnected until reset.
  [[nodiscard]] SendResult send(std::span<const CanFrame> frames) noexcept override;
  [[nodiscard]] ReceiveResult receive(std::span<CanFrame> frames) noexcept override;

  [[nodiscard]] BusHealth health() const noexcept override { return health_; }
  void clear_bus_off() noexcept override {
    if (carrier_lost_) confirmations_.forget();  // what was sent since is not on the bus
    counters_.echoes_lost += confirmations_.try_again();
    health_ = BusHealth::active;
  }
  [[nodiscard]] const BusCounters& counters() const noexcept override { return counters_; }

  /// Commands sent and not seen on the bus yet.
  [[nodiscard]] std::size_t unconfirmed() const noexcept { return confirmations_.size(); }

 private:
  static constexpr std::size_t kControlBytes = 128;

  struct Batch {
    std::array<WireFrame, kMaximumBatch> wire;
    std::array<iovec, kMaximumBatch> vectors;
    std::array<mmsghdr, kMaximumBatch> headers;
    std::array<std::array<std::byte, kControlBytes>, kMaximumBatch> control;
  };

  [[nodiscard]] bool must_wait(std::span<const CanFrame> frames, std::size_t i,
                               std::span<const std::uint8_t> taken) const noexcept;
  std::size_t collect(std::span<const CanFrame> frames, std::array<std::uint8_t, kMaximumBatch>& taken,
                      BusStatus& status) noexcept;
  [[nodiscard]] BusStatus failure(int error_number) noexcept;
  void prepare_receive(std::size_t count) noexcept;
  /// One message; true when it is a frame of another node, then written to `frame`.
  [[nodiscard]] bool take(std::size_t index, CanFrame& frame) noexcept;
  void take_control(msghdr& header) noexcept;
  void take_error(const CanFrame& frame) noexcept;
  void lose_connection() noexcept;

  int descriptor_;
  Echo echo_;
  SocketCalls calls_;
  bool gone_ = false;
  bool carrier_lost_ = false;  ///< went off the bus, and has not restarted since
  std::uint32_t overflow_total_ = 0;
  std::size_t first_ = 0;  ///< of the next batch, from 0
  BusHealth health_ = BusHealth::active;
  BusCounters counters_;
  Confirmations confirmations_;
  Batch batch_{};
};

/// Marks a frame as an echo, in a byte of linux/can.h that SocketCAN leaves zero. Only on the loopback bus.
void mark_echo(std::span<std::byte> wire) noexcept;
[[nodiscard]] bool marked_echo(std::span<const std::byte> wire) noexcept;

}  // namespace stilt::hal::socketcan
