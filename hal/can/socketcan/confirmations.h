#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/can/frame.h"

namespace stilt::hal::socketcan {

/// Identifiers sent and not yet seen on the bus. A second frame with one of them has to wait: so at most one
/// command of a joint is ever queued, and what was queued for an unpowered driver cannot burst out later. The
/// kernel sends in order, and a controller with several mailboxes by priority: a frame that more than
/// kOvertaken later ones have passed is not delayed, its echo is lost (USB adapters lose some). Fixed memory,
/// real-time safe.
class Confirmations {
 public:
  static constexpr std::size_t kCapacity = 32;
  static constexpr std::uint64_t kOvertaken =
      6;  ///< fewer ticks than the supervisor waits for a joint's reply

  [[nodiscard]] bool waiting(const CanFrame& frame) const noexcept { return find(key(frame)) < count_; }

  /// False when the table is full.
  [[nodiscard]] bool sent(const CanFrame& frame) noexcept {
    if (count_ == kCapacity) return false;
    keys_[count_] = key(frame);
    orders_[count_++] = sent_++;
    return true;
  }

  /// An echo arrived. @return  how many earlier ones are given up
  std::size_t confirm(const CanFrame& frame) noexcept {
    const std::size_t index = find(key(frame));
    if (index == count_) return 0;
    const std::uint64_t order = orders_[index];
    remove(index);
    std::size_t lost = 0;
    for (std::size_t i = count_; i-- > 0;) {
      if (orders_[i] + kOvertaken >= order) continue;
      remove(i);
      ++lost;
    }
    return lost;
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

  void remove(std::size_t index) noexcept {
    --count_;
    keys_[index] = keys_[count_];
    orders_[index] = orders_[count_];
  }

  std::array<std::uint32_t, kCapacity> keys_{};
  std::array<std::uint64_t, kCapacity> orders_{};  ///< of sending, of the same entries
  std::size_t count_ = 0;
  std::uint64_t sent_ = 0;
};

}  // namespace stilt::hal::socketcan
