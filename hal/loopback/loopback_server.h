#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <string>

#include "hal/can/socketcan/descriptor.h"
#include "hal/can/socketcan/frame_socket.h"
#include "hal/loopback/loopback_address.h"

namespace stilt::hal::loopback {

/// The simulated robot's end of a loopback bus. Listens at a name, serves one controller at a time, and the
/// next one after that has gone. Further ones are refused: the bus is busy.
class LoopbackServer final : public FrameBus {
 public:
  /// Fails when the name is in use. The error is one sentence for the user.
  [[nodiscard]] std::expected<void, std::string> open(const std::string& name);

  /// disconnected while no controller is there.
  [[nodiscard]] SendResult send(std::span<const CanFrame> frames) noexcept override;

  /// Takes frames of the controller and returns each as echo; also lets a controller in.
  [[nodiscard]] ReceiveResult receive(std::span<CanFrame> frames) noexcept override;

  [[nodiscard]] bool connected() const noexcept { return socket_.connected(); }
  /// Controllers let in since open.
  [[nodiscard]] std::uint64_t connections() const noexcept { return connections_; }
  /// Controllers refused because the bus is busy.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

  /// While true, frames are taken but neither returned nor delivered, as if no node acknowledged them: what a
  /// bus with unpowered drivers looks like.
  void set_silent(bool silent) noexcept { silent_ = silent; }

  /// Ends the connection, as if the cable came off; the controller may come back with the next receive().
  void hang_up() noexcept;

  /// For poll(): readable when a frame waits, or a controller where none is connected.
  [[nodiscard]] int listener() const noexcept { return listener_.get(); }
  [[nodiscard]] int descriptor() const noexcept { return client_.get(); }

  [[nodiscard]] BusHealth health() const noexcept override { return BusHealth::active; }
  void clear_bus_off() noexcept override {}
  [[nodiscard]] const BusCounters& counters() const noexcept override { return socket_.counters(); }

 private:
  [[nodiscard]] bool client_has_left() const noexcept;
  void let_in() noexcept;
  void return_echo(const CanFrame& frame) noexcept;

  socketcan::Descriptor listener_;
  socketcan::Descriptor client_;
  socketcan::FrameSocket socket_{-1, socketcan::Echo::none};
  std::uint64_t connections_ = 0;
  std::uint64_t refused_ = 0;
  bool silent_ = false;
};

}  // namespace stilt::hal::loopback
