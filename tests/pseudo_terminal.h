#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <span>
#include <string>
#include <system_error>

namespace stilt::tests {

/// A pseudo-terminal: the test's end, and the name of the port at the other.
class PseudoTerminal {
 public:
  PseudoTerminal() : end_(posix_openpt(O_RDWR | O_NOCTTY)) {
    char name[64];
    if (end_ < 0 || grantpt(end_) != 0 || unlockpt(end_) != 0 || ptsname_r(end_, name, sizeof name) != 0)
      throw std::system_error(errno, std::generic_category(), "pseudo-terminal");
    port_ = name;
  }
  ~PseudoTerminal() { hang_up(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  void write(std::span<const std::uint8_t> bytes) const {
    if (::write(end_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      throw std::system_error(errno, std::generic_category(), "write");
  }
  /// What the port's other end has written, at most this long after the call; it may be nothing.
  [[nodiscard]] std::string read(int timeout_ms) const {
    pollfd waited{end_, POLLIN, 0};
    char bytes[4096];
    if (poll(&waited, 1, timeout_ms) <= 0 || (waited.revents & POLLIN) == 0) return "";
    const ssize_t count = ::read(end_, bytes, sizeof bytes);
    return count > 0 ? std::string(bytes, static_cast<std::size_t>(count)) : "";
  }
  /// As when an adapter is unplugged.
  void hang_up() {
    if (end_ >= 0) close(end_);
    end_ = -1;
  }
  [[nodiscard]] const std::string& port() const { return port_; }

 private:
  int end_;
  std::string port_;
};

}  // namespace stilt::tests
