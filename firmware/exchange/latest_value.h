#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

#include "hal/exchange/cache_line.h"

namespace stilt::exchange {

/// Hands the newest value of one thread to one other thread. Wait-free on both sides, no lock, no copy. Of
/// three slots the writer fills one, the reader reads one, and the third waits in the middle. Publishing and
/// taking swap slots with it. A value that was not taken before the next one came is lost, which is the
/// point.
///
/// The swaps are acquire and release both ways. The reader gets the whole value, and the writer gets a slot
/// back only after the last look at it.
///
/// @tparam T       owns nothing outside of itself; starts as T{}
/// @tparam Atomic  std::atomic, or a model of it in tests
template <class T, template <class> class Atomic = std::atomic>
class LatestValue {
  static_assert(std::is_trivially_destructible_v<T>, "values are memory of fixed size and own nothing");

 public:
  /// Writer's thread only: the slot to fill. Holds an old value, anything of it may be overwritten.
  /// Real-time.
  [[nodiscard]] T& writer() noexcept { return slots_[writing_]; }

  /// Writer's thread only: what writer() gave is now the newest value; writer() gives another. Real-time.
  void publish() noexcept {
    writing_ = middle_.exchange(writing_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }

  /// Reader's thread only: the newest value, T{} before the first. The reference stays valid and its contents
  /// unchanged until the next call. Real-time.
  [[nodiscard]] const T& newest() noexcept {
    if (has_news()) reading_ = middle_.exchange(reading_, std::memory_order_acq_rel) & kIndex;
    return slots_[reading_];
  }

  /// Reader's thread only: whether newest() would give a value not given before. Real-time.
  [[nodiscard]] bool has_news() const noexcept {
    return (middle_.load(std::memory_order_relaxed) & kFresh) != 0;
  }

 private:
  static constexpr std::uint32_t kIndex = 3;
  static constexpr std::uint32_t kFresh = 4;  ///< set by the writer, cleared by the reader's swap

  alignas(kCacheLine_bytes) Atomic<std::uint32_t> middle_{1};
  alignas(kCacheLine_bytes) std::uint32_t writing_ = 0;
  alignas(kCacheLine_bytes) std::uint32_t reading_ = 2;
  alignas(kCacheLine_bytes) std::array<T, 3> slots_{};
};

}  // namespace stilt::exchange
