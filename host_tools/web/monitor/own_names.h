#pragma once

#include <string>
#include <vector>

namespace stilt::monitor {

/// Which host names and addresses lead to a server.
struct OwnNames {
  std::string address;             ///< that it listens on: "127.0.0.1", "0.0.0.0"
  std::vector<std::string> named;  ///< further ones, given by the user: "robot.example.com"

  /// Whether a Host header, "host" or "host:port", names this server. Any other name is that of a site which
  /// has directed its own name here (DNS rebinding). On loopback: the loopback addresses and "localhost".
  /// On every address: also the addresses of this machine, its host name, and that in .local.
  [[nodiscard]] bool contain(const std::string& host_header) const;

  /// Addresses under which another machine reaches this server; none on loopback.
  [[nodiscard]] std::vector<std::string> for_others() const;
};

/// "[::1]" for "::1"; other addresses as they are.
[[nodiscard]] std::string in_brackets(const std::string& address);

}  // namespace stilt::monitor
