#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hal/exchange/cache_line.h"

namespace stilt::exchange {

/// Keeps the last records of one thread. It freezes some records after something happened, so that another
/// thread can read at leisure what was before and after. Until rearm() nothing is recorded. Wait-free on the
/// recording side.
///
/// Either side touches the records only when the state shows they are its own: recorder while recording,
/// reader while frozen. Each hands them over with a release that the other acquires.
///
/// @tparam T          owns nothing outside of itself
/// @tparam kCapacity  records kept
/// @tparam Atomic     std::atomic, or a model of it in tests
template <class T, std::size_t kCapacity, template <class> class Atomic = std::atomic>
class BlackBox {
  static_assert(std::is_trivially_destructible_v<T>, "records are memory of fixed size and own nothing");

 public:
  /// Records that still follow after a trigger. Before the recording begins.
  void set_aftermath(std::size_t records) noexcept {
    aftermath_ = records < kCapacity ? records : kCapacity - 1;
  }

  /// Recorder only: the record to fill in this tick; nullptr while frozen. Real-time.
  [[nodiscard]] T* claim() noexcept {
    if (state_.load(std::memory_order_acquire) == kFrozen) return nullptr;
    if (frozen_) frozen_ = triggered_ = false;
    return &records_[next_];
  }

  /// Recorder only, after claim() gave a record: keeps it.
  /// @param trigger  something happened; further triggers before the freeze change nothing
  void commit(bool trigger) noexcept {
    next_ = (next_ + 1) % kCapacity;
    if (count_ < kCapacity) ++count_;
    if (triggered_) {
      --left_;
    } else if (trigger) {
      triggered_ = true;
      left_ = aftermath_;
    }
    if (!triggered_ || left_ != 0) return;
    frozen_ = true;
    state_.store(kFrozen, std::memory_order_release);
  }

  /// Reader: whether the records stand still and may be read.
  [[nodiscard]] bool frozen() const noexcept { return state_.load(std::memory_order_acquire) == kFrozen; }

  /// Anyone when the recorder has ended: whether something happened whose aftermath was cut short.
  [[nodiscard]] bool cut_short() const noexcept { return triggered_ && !frozen_; }

  /// Reader while frozen, or anyone when the recorder has ended: number of records.
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

  /// As above: a record, 0 is the oldest.
  [[nodiscard]] const T& record(std::size_t index) const noexcept {
    return records_[(next_ + kCapacity - count_ + index) % kCapacity];
  }

  /// As above, once something happened: the record of the trigger.
  [[nodiscard]] std::size_t trigger() const noexcept { return count_ - 1 - (aftermath_ - left_); }

  /// Reader while frozen: recording goes on, after the records that are there. Those of the meantime are
  /// missing.
  void rearm() noexcept { state_.store(kRecording, std::memory_order_release); }

 private:
  static constexpr std::uint32_t kRecording = 0;
  static constexpr std::uint32_t kFrozen = 1;

  alignas(exchange::kCacheLine_bytes) Atomic<std::uint32_t> state_{kRecording};
  std::size_t aftermath_ = 0;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::size_t left_ = 0;
  bool triggered_ = false;
  bool frozen_ = false;  ///< whether the recorder has frozen it
  std::array<T, kCapacity> records_{};
};

}  // namespace stilt::exchange
