#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/can/frame.h"

namespace stilt::hal::socketcan {

/// Identifiers sent and not yet seen on the bus. A second frame with one of them has to wait: so at most one
/// command of a joint is ever queued, and what was queued for an unpowered driver cannot burst out later.
/// Fixed memory, real-time safe.
class Confirmations {
 public:
  static constexpr std::size_t kCapacity = 32;

  [[nodiscard]] bool waiting(const CanFrame& frame) const noexcept { return find(key(frame)) < count_; }

  /// False when the table is full.
  [[nodiscard]] bool sent(const CanFrame& frame) noexcept {
    if (count_ == kCapacity) return false;
    keys_[count_++] = key(frame);
    return true;
  }

  /// An echo arrived. False when nothing was waiting for it.
  bool confirm(const CanFrame& frame) noexcept {
    const std::size_t index = find(key(frame));
    if (index == count_) return false;
    keys_[index] = keys_[--count_];
    return true;
  }

  /// Echoes may have been lost, or the queue was flushed.
  void forget() noexcept { count_ = 0; }

  /// Whether two frames have the same identifier, as far as confirmation goes.
  [[nodiscard]] static bool same(const CanFrame& a, const CanFrame& b) noexcept { return key(a) == key(b); }

  [[nodiscard]] std::size_t size() const noexcept { return count_; }

 private:
  static std::uint32_t key(const CanFrame& frame) noexcept {
    return frame.id | (frame.extended ? 0x80000000u : 0u) | (frame.remote ? 0x40000000u : 0u);
  }
  [[nodiscard]] std::size_t find(std::uint32_t key) const noexcept {
    std::size_t i = 0;
    while (i < count_ && keys_[i] != key) ++i;
    return i;
  }

  std::array<std::uint32_t, kCapacity> keys_{};
  std::size_t count_ = 0;
};

}  // namespace stilt::hal::socketcan
