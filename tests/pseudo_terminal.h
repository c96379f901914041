#pragma once

#include <fcntl.h>
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
