#include "host_tools/simulation/robot_on_bus/robot_bus.h"

#include <stdexcept>

namespace stilt::robot_on_bus {
namespace {

using hal::loopback::LoopbackServer;
using hal::socketcan::SocketCanBus;

}  // namespace

RobotBus::RobotBus(const std::string& name, bool fd)
    : name_(name), bus_(std::make_unique<std::variant<LoopbackServer, SocketCanBus>>()) {
  std::expected<void, std::string> opened;
  if (name.starts_with(hal::loopback::kPrefix)) {
    opened = bus_->emplace<LoopbackServer>().open(name.substr(hal::loopback::kPrefix.size()));
  } else {
    hal::socketcan::BusOptions options;
    options.fd = fd;
    opened = bus_->emplace<SocketCanBus>().open(name, options);
  }
  if (!opened) throw std::invalid_argument("--bus " + name + ": " + opened.error());
}

hal::FrameBus& RobotBus::frames() {
  if (auto* server = std::get_if<LoopbackServer>(bus_.get())) return *server;
  return std::get<SocketCanBus>(*bus_).frames();
}

bool RobotBus::connected() const {
  const auto* server = std::get_if<LoopbackServer>(bus_.get());
  return server == nullptr || server->connected();
}

std::uint64_t RobotBus::connections() const {
  const auto* server = std::get_if<LoopbackServer>(bus_.get());
  return server == nullptr ? 1 : server->connections();
}

int RobotBus::descriptor() const {
  if (const auto* server = std::get_if<LoopbackServer>(bus_.get())) {
    return server->connected() ? server->descriptor() : server->listener();
  }
  return std::get<SocketCanBus>(*bus_).frames().descriptor();
}

void RobotBus::hang_up() {
  if (auto* server = std::get_if<LoopbackServer>(bus_.get())) server->hang_up();
}

bool RobotBus::is_loopback() const { return std::holds_alternative<LoopbackServer>(*bus_); }

}  // namespace stilt::robot_on_bus
