#include "firmware/realtime/idle_request.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

namespace stilt::realtime {

IdleRequest::IdleRequest(double exit_max_s, const std::string& root) : reason_() {
  descriptor_ = open((root + "/dev/cpu_dma_latency").c_str(), O_WRONLY | O_CLOEXEC);
  const auto exit_max_us = static_cast<std::int32_t>(std::lround(1e6 * exit_max_s));
  if (descriptor_ >= 0 && write(descriptor_, &exit_max_us, sizeof exit_max_us) == sizeof exit_max_us) return;
  reason_ = std::strerror(errno);
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
}

IdleRequest::IdleRequest(IdleRequest&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), reason_(std::move(other.reason_)) {}

IdleRequest& IdleRequest::operator=(IdleRequest&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(reason_, other.reason_);
  return *this;
}

IdleRequest::~IdleRequest() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace stilt::realtime
