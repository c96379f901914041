#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/can/frame.h"

namespace stilt::hal::socketcan {

/// Identifiers sent and not yet seen on the bus. A second frame with one of them has to wait, so that few
/// commands of a joint are ever queued. Those go out when a node acknowledges them, however late. On a bus
/// where no node has power the controller repeats the first for ever, also when the socket is closed. Only
/// the interface taken down drops them (docs/hazards.md).
///
/// USB adapters lose some echoes. Two rules end the wait for one of those:
/// - The kernel sends in order, and a controller with several mailboxes by priority. A frame that more than
///   kOvertaken later ones have passed is not delayed.
/// - Where all echoes of a bus are lost nothing is sent, so nothing can pass. After kOvertaken refusals in a
///   row an identifier may be sent again, then after twice and four times as many. After kTries of them only
///   a reset (try_again) lets it through. So a silent bus never holds more than 1 + kTries frames of an
///   identifier.
///
/// Fixed memory, real-time safe.
class Confirmations {
 public:
  static constexpr std::size_t kCapacity = 32;
  /// Fewer ticks than the supervisor waits for a joint's reply, and fewer than disable the drivers at the end
  /// of a program.
  static constexpr std::uint64_t kOvertaken = 6;
  static constexpr std::uint32_t kTries = 3;

  /// Whether a frame with this identifier has to wait.
  [[nodiscard]] bool waiting(const CanFrame& frame) const noexcept {
    const std::size_t index = find(key(frame));
    return index < count_ && !entries_[index].given_up;
  }

  /// Whether the table holds it, beside so many others.
  [[nodiscard]] bool has_room(const CanFrame& frame, std::size_t others) const noexcept {
    return count_ + others < kCapacity || find(key(frame)) < count_;
  }

  /// A frame that has to wait was refused. @return  whether the echo is given up now: the next one may be
  /// sent
  [[nodiscard]] bool refuse(const CanFrame& frame, bool may_give_up) noexcept {
    const std::size_t index = find(key(frame));
    if (index == count_ || entries_[index].given_up) return false;
    Entry& entry = entries_[index];
    ++entry.refusals;
    if (!may_give_up || entry.tries >= kTries || entry.refusals < kOvertaken << entry.tries) return false;
    ++entry.tries;
    entry.given_up = true;
    return true;
  }

  /// False when the table is full.
  [[nodiscard]] bool sent(const CanFrame& frame) noexcept {
    const std::size_t index = find(key(frame));
    if (index == kCapacity) return false;
    const std::uint32_t tries = index < count_ ? entries_[index].tries : 0;
    count_ += index == count_ ? 1 : 0;
    entries_[index] = {.key = key(frame), .order = sent_++, .tries = tries};
    return true;
  }

  /// An echo arrived. @return  how many earlier ones are given up
  std::size_t confirm(const CanFrame& frame) noexcept {
    const std::size_t index = find(key(frame));
    if (index == count_) return 0;
    const std::uint64_t order = entries_[index].order;
    remove(index);
    std::size_t lost = 0;
    for (std::size_t i = count_; i-- > 0;) {
      if (entries_[i].order + kOvertaken >= order) continue;
      lost += entries_[i].given_up ? 0 : 1;
      remove(i);
    }
    return lost;
  }

  /// Echoes may have been lost, or the queue was flushed.
  void forget() noexcept { count_ = 0; }

  /// Drops identifiers that were refused so often that their echo may be lost. @return  how many
  std::size_t try_again() noexcept {
    std::size_t lost = 0;
    for (std::size_t i = count_; i-- > 0;) {
      if (entries_[i].refusals < kOvertaken) continue;
      lost += entries_[i].given_up ? 0 : 1;
      remove(i);
    }
    return lost;
  }

  /// Whether two frames have the same identifier, as far as confirmation goes.
  [[nodiscard]] static bool same(const CanFrame& a, const CanFrame& b) noexcept { return key(a) == key(b); }

  [[nodiscard]] std::size_t size() const noexcept { return count_; }

 private:
  struct Entry {
    std::uint32_t key = 0;
    std::uint64_t order = 0;     ///< of sending
    std::uint32_t tries = 0;     ///< sent again without an echo
    std::uint64_t refusals = 0;  ///< since it was sent last
    bool given_up = false;
  };

  static std::uint32_t key(const CanFrame& frame) noexcept {
    return frame.id | (frame.extended ? 0x80000000u : 0u) | (frame.remote ? 0x40000000u : 0u);
  }
  [[nodiscard]] std::size_t find(std::uint32_t key) const noexcept {
    std::size_t i = 0;
    while (i < count_ && entries_[i].key != key) ++i;
    return i;
  }
  void remove(std::size_t index) noexcept { entries_[index] = entries_[--count_]; }

  std::array<Entry, kCapacity> entries_{};
  std::size_t count_ = 0;
  std::uint64_t sent_ = 0;
};

}  // namespace stilt::hal::socketcan
