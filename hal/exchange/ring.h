#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hal/exchange/cache_line.h"

namespace stilt::exchange {

/// First in, first out, from one thread to one other thread. Wait-free on both sides. When it is full the new
/// element is dropped and counted: the producer is the real-time side and never waits.
///
/// Elements are written and read in place:
///
///   if (T* slot = ring.claim()) { fill *slot; ring.commit(); }
///   while (const T* element = ring.front()) { use *element; ring.pop(); }
///
/// @tparam T          owns nothing outside of itself
/// @tparam kCapacity  elements, a power of two
/// @tparam Atomic     std::atomic, or a model of it in tests
template <class T, std::size_t kCapacity, template <class> class Atomic = std::atomic>
class Ring {
  static_assert(std::is_trivially_destructible_v<T>, "elements are memory of fixed size and own nothing");
  static_assert(std::has_single_bit(kCapacity), "the counters wrap around at a power of two");

 public:
  /// Producer only: the slot of the next element; nullptr, and one more dropped, when there is no room.
  /// Real-time.
  /// @param spare  places that stay free for other elements, at most the capacity
  [[nodiscard]] T* claim(std::size_t spare = 0) noexcept {
    const std::size_t written = written_.load(std::memory_order_relaxed);
    if (written - read_.load(std::memory_order_acquire) >= kCapacity - spare) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return nullptr;
    }
    return &elements_[written % kCapacity];
  }

  /// Producer only, after claim() gave a slot: hands it over. Real-time.
  void commit() noexcept {
    written_.store(written_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Producer only: copies an element in. False when it was dropped. Real-time.
  bool push(const T& element, std::size_t spare = 0) noexcept {
    T* slot = claim(spare);
    if (slot == nullptr) return false;
    *slot = element;
    commit();
    return true;
  }

  /// Consumer only: the oldest element, nullptr when there is none. Valid until pop(). Real-time.
  [[nodiscard]] const T* front() const noexcept {
    const std::size_t read = read_.load(std::memory_order_relaxed);
    if (written_.load(std::memory_order_acquire) == read) return nullptr;
    return &elements_[read % kCapacity];
  }

  /// Consumer only, after front() gave an element: gives its slot back. Real-time.
  void pop() noexcept { read_.store(read_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

  /// Elements lost since the start. Any thread, real-time.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return kCapacity; }

 private:
  alignas(kCacheLine_bytes) Atomic<std::size_t> written_{0};  ///< elements ever committed
  Atomic<std::uint64_t> dropped_{0};
  alignas(kCacheLine_bytes) Atomic<std::size_t> read_{0};  ///< elements ever given back
  alignas(kCacheLine_bytes) std::array<T, kCapacity> elements_{};
};

}  // namespace stilt::exchange
