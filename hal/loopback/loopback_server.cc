#include "hal/loopback/loopback_server.h"

#include <poll.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

namespace stilt::hal::loopback {
namespace {

constexpr int kBacklog = 4;

void greet(int descriptor, Greeting greeting) noexcept {
  const GreetingBytes bytes = greeting_bytes(greeting);
  static_cast<void>(::send(descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
}

}  // namespace

std::expected<void, std::string> LoopbackServer::open(const std::string& name) {
  if (!valid_name(name)) {
    return std::unexpected("bus loopback:" + name +
                           ": a name has 1 to 64 letters, digits, '.', '_' or '-', like loopback:robot");
  }
  socketcan::Descriptor listener(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const Address address = address_of(name);
  if (!listener.open() ||
      ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address.address), address.length) != 0 ||
      ::listen(listener.get(), kBacklog) != 0) {
    if (errno == EADDRINUSE)
      return std::unexpected("bus loopback:" + name + ": another robot listens at this name");
    return std::unexpected("bus loopback:" + name + ": cannot listen: " + std::strerror(errno));
  }
  listener_ = std::move(listener);
  client_.close();
  socket_.reset(-1);
  return {};
}

/// The end of a connection shows before its last frames are read.
bool LoopbackServer::client_has_left() const noexcept {
  pollfd client{client_.get(), 0, 0};
  return client_.open() && ::poll(&client, 1, 0) == 1 && (client.revents & POLLHUP) != 0;
}

void LoopbackServer::let_in() noexcept {
  if (client_has_left()) return;  // who waits comes in once its last frames are read
  socketcan::Descriptor caller(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!caller.open()) return;
  if (socket_.connected()) {
    greet(caller.get(), Greeting::busy);
    ++refused_;
    return;
  }
  greet(caller.get(), Greeting::welcome);
  client_ = std::move(caller);
  socket_.reset(client_.get());
  ++connections_;
}

SendResult LoopbackServer::send(std::span<const CanFrame> frames) noexcept {
  return silent_ ? SendResult{0, BusStatus::queue_full} : socket_.send(frames);
}

void LoopbackServer::return_echo(const CanFrame& frame) noexcept {
  socketcan::WireFrame wire;
  const std::size_t bytes = socketcan::to_wire(frame, wire);
  socketcan::mark_echo(wire);
  static_cast<void>(::send(client_.get(), wire.data(), bytes, MSG_DONTWAIT | MSG_NOSIGNAL));
}

void LoopbackServer::hang_up() noexcept {
  client_.close();
  socket_.reset(-1);
}

ReceiveResult LoopbackServer::receive(std::span<CanFrame> frames) noexcept {
  ReceiveResult result = socket_.receive(frames);
  if (result.status == BusStatus::disconnected && client_.open()) hang_up();
  if (silent_) result.received = 0;
  for (const CanFrame& frame : frames.first(result.received)) return_echo(frame);
  let_in();
  return result;
}

}  // namespace stilt::hal::loopback
