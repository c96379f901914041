#include "hal/any_bus.h"

#include <utility>

namespace stilt::hal {

std::expected<void, std::string> AnyBus::open(const std::string& name, const socketcan::BusOptions& options,
                                              int priority) {
  name_ = name;
  if (name.starts_with(loopback::kPrefix)) {
    bus_ = std::make_unique<Kinds>(std::in_place_type<loopback::LoopbackClient>);
    return std::get<loopback::LoopbackClient>(*bus_).open(name.substr(loopback::kPrefix.size()));
  }
  if (name.starts_with(fdcanusb::kPrefix)) {
    bus_ = std::make_unique<Kinds>(std::in_place_type<fdcanusb::FdcanusbBus>);
    return std::get<fdcanusb::FdcanusbBus>(*bus_).open(
        name.substr(fdcanusb::kPrefix.size()), {.receive_ids = options.receive_ids, .priority = priority});
  }
  bus_ = std::make_unique<Kinds>(std::in_place_type<socketcan::SocketCanBus>);
  return std::get<socketcan::SocketCanBus>(*bus_).open(name, options);
}

std::expected<void, std::string> AnyBus::lock(const std::string& name) {
  auto taken = BusLock::take(name);
  if (!taken) return std::unexpected(taken.error());
  lock_ = std::move(*taken);
  return {};
}

bool AnyBus::reconnect() noexcept {
  if (auto* client = std::get_if<loopback::LoopbackClient>(bus_.get())) {
    return client->reconnect() == loopback::Connection::connected;
  }
  if (auto* adapter = std::get_if<fdcanusb::FdcanusbBus>(bus_.get())) return adapter->reconnect();
  auto* can = std::get_if<socketcan::SocketCanBus>(bus_.get());
  return can != nullptr && (can->frames().connected() || can->reopen());
}

FrameBus& AnyBus::frames() noexcept {
  if (auto* client = std::get_if<loopback::LoopbackClient>(bus_.get())) return client->frames();
  if (auto* adapter = std::get_if<fdcanusb::FdcanusbBus>(bus_.get())) return adapter->frames();
  return std::get_if<socketcan::SocketCanBus>(bus_.get())->frames();
}

std::size_t AnyBus::unconfirmed() noexcept {
  if (auto* client = std::get_if<loopback::LoopbackClient>(bus_.get())) return client->frames().unconfirmed();
  auto* can = std::get_if<socketcan::SocketCanBus>(bus_.get());
  return can != nullptr ? can->frames().unconfirmed() : 0;
}

}  // namespace stilt::hal
