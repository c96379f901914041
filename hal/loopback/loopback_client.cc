#include "hal/loopback/loopback_client.h"

#include <poll.h>

#include <cerrno>
#include <utility>

namespace stilt::hal::loopback {
namespace {

std::string sentence(const std::string& name, Connection state) {
  const std::string bus = "bus loopback:" + name;
  switch (state) {
    case Connection::no_listener:
      return bus + ": no program listens there; start `stilt robot --bus loopback:" + name + "` first";
    case Connection::busy:
      return bus + ": another controller is connected; stop it first";
    case Connection::protocol_mismatch:
      return bus + ": the listener there does not speak this version of the bus";
    case Connection::waiting:
    case Connection::connected:
      break;
  }
  return bus + ": the robot listens but does not answer";
}

}  // namespace

std::expected<void, std::string> LoopbackClient::open(const std::string& name, int timeout_ms) {
  if (!valid_name(name)) {
    return std::unexpected("bus loopback:" + name +
                           ": a name has 1 to 64 letters, digits, '.', '_' or '-', like loopback:robot");
  }
  name_ = name;
  descriptor_.close();
  greeted_ = false;
  Connection state = reconnect();
  if (state == Connection::waiting) {
    pollfd waiting{descriptor_.get(), POLLIN, 0};
    static_cast<void>(::poll(&waiting, 1, timeout_ms));
    state = reconnect();
  }
  if (state != Connection::connected) {
    descriptor_.close();
    return std::unexpected(sentence(name, state));
  }
  return {};
}

Connection LoopbackClient::reconnect() noexcept {
  if (greeted_ && socket_.connected()) return Connection::connected;
  if (greeted_) {
    descriptor_.close();
    greeted_ = false;
  }
  if (!descriptor_.open()) {
    socketcan::Descriptor fresh(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const Address address = address_of(name_);
    if (!fresh.open() ||
        ::connect(fresh.get(), reinterpret_cast<const sockaddr*>(&address.address), address.length) != 0) {
      return Connection::no_listener;
    }
    descriptor_ = std::move(fresh);
  }
  return read_greeting();
}

Connection LoopbackClient::read_greeting() noexcept {
  GreetingBytes bytes{};
  const ssize_t size = ::recv(descriptor_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return Connection::waiting;
  if (size <= 0) {
    descriptor_.close();
    return Connection::no_listener;
  }
  const std::optional<Greeting> greeting = loopback::read_greeting(bytes, static_cast<std::size_t>(size));
  if (greeting != Greeting::welcome) {
    descriptor_.close();
    return greeting == Greeting::busy ? Connection::busy : Connection::protocol_mismatch;
  }
  greeted_ = true;
  socket_.reset(descriptor_.get());
  return Connection::connected;
}

}  // namespace stilt::hal::loopback
