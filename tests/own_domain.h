#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <stdexcept>
#include <string>

namespace stilt::tests {

/// A DDS domain that no other test process of this machine has, however many run at once. Who holds the lock
/// of its file has it. Programs that this process starts inherit the lock, so that one left behind keeps its
/// domain to itself. The same files as tests/own_domain.py.
[[nodiscard]] inline int own_domain() {
  // Domain 0 is stiltd's own; beyond 100 ports may be taken already.
  constexpr int kFirst = 5, kLast = 94;
  static const int kDomain = [] {
    for (int domain = kFirst; domain <= kLast; ++domain) {
      const int file =
          open(("/tmp/stilt-test-domain-" + std::to_string(domain)).c_str(), O_RDWR | O_CREAT, 0666);
      if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return domain;
      if (file >= 0) close(file);
    }
    throw std::runtime_error("no DDS domain is free for this test: /tmp/stilt-test-domain-* are all locked");
  }();
  return kDomain;
}

}  // namespace stilt::tests
