#include "firmware/diagnostics/input_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace stilt::diagnostics {
namespace {

constexpr std::size_t kMost_bytes = 64 * 1024 * 1024;

/// @return  0, or the number of the error
int read_all(int descriptor, std::string& text) {
  std::array<char, 4096> bytes;
  for (;;) {
    const ssize_t count = ::read(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count < 0 ? errno : 0;
    text.append(bytes.data(), static_cast<std::size_t>(count));
    if (text.size() > kMost_bytes) return EFBIG;
  }
}

}  // namespace

std::expected<std::string, std::string> read_file(const std::string& name) {
  const int descriptor = ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return std::unexpected(std::strerror(errno));
  std::string text;
  const int error = read_all(descriptor, text);
  ::close(descriptor);
  if (error != 0) return std::unexpected(std::strerror(error));
  return text;
}

}  // namespace stilt::diagnostics
