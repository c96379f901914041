#include "hal/bus_lock.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace stilt::hal {

std::expected<BusLock, std::string> BusLock::take(const std::string& bus) {
  const std::string name = "stilt/commands/" + bus;
  sockaddr_un address{};
  if (name.size() + 1 > sizeof address.sun_path)
    return std::unexpected("bus " + bus + ": the name is too long");
  address.sun_family = AF_UNIX;
  std::copy(name.begin(), name.end(), address.sun_path + 1);  // abstract: the first byte is 0
  BusLock lock(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (lock.socket_.open() &&
      bind(lock.socket_.get(), reinterpret_cast<const sockaddr*>(&address), length) == 0)
    return lock;
  if (errno == EADDRINUSE) {
    return std::unexpected("bus " + bus +
                           ": another stiltd, or its selftest, commands the drivers; end it first");
  }
  return std::unexpected("bus " + bus + ": cannot be locked (" + std::strerror(errno) + ")");
}

}  // namespace stilt::hal
