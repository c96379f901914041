#include "firmware/telemetry/udp_sockets.h"

#include <dirent.h>
#include <net/if.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>

// Why: docs/decisions/0020-one-commander.md
namespace stilt::telemetry {
namespace {

struct CloseFolder {
  void operator()(DIR* folder) const { closedir(folder); }
};

int option(int socket, int name) {
  int value = 0;
  socklen_t size = sizeof value;
  return getsockopt(socket, SOL_SOCKET, name, &value, &size) == 0 ? value : -1;
}

/// Once restricted, a socket stays so without a capability for another try.
bool is_restricted(int socket, const std::string& interface) {
  std::array<char, IFNAMSIZ> name{};
  socklen_t size = name.size();
  return getsockopt(socket, SOL_SOCKET, SO_BINDTODEVICE, name.data(), &size) == 0 && interface == name.data();
}

}  // namespace

std::expected<std::set<int>, std::string> udp_sockets() {
  std::set<int> sockets;
  const std::unique_ptr<DIR, CloseFolder> folder(opendir("/proc/self/fd"));
  if (!folder) {
    return std::unexpected(std::string("telemetry cannot find its own sockets: /proc/self/fd: ") +
                           std::strerror(errno) + "; mount /proc, and allow more open files (ulimit -n)");
  }
  while (const dirent* entry = readdir(folder.get())) {
    char* end = nullptr;
    const int number = static_cast<int>(std::strtol(static_cast<const char*>(entry->d_name), &end, 10));
    const bool is_number = end != entry->d_name && *end == '\0';
    const bool is_ip = option(number, SO_DOMAIN) == AF_INET || option(number, SO_DOMAIN) == AF_INET6;
    if (is_number && is_ip && option(number, SO_TYPE) == SOCK_DGRAM) sockets.insert(number);
  }
  return sockets;
}

std::expected<void, std::string> restrict_new_sockets(const std::set<int>& before,
                                                      const std::string& interface) {
  const auto sockets = udp_sockets();
  if (!sockets) return std::unexpected(sockets.error());
  for (const int socket : *sockets) {
    if (before.contains(socket) || is_restricted(socket, interface)) continue;
    const auto size = static_cast<socklen_t>(interface.size());
    if (setsockopt(socket, SOL_SOCKET, SO_BINDTODEVICE, interface.data(), size) == 0) continue;
    return std::unexpected("telemetry cannot be kept to interface " + interface + ": " +
                           std::strerror(errno) +
                           "; Linux 5.7 or newer lets every user, older ones the capability CAP_NET_RAW");
  }
  return {};
}

}  // namespace stilt::telemetry
