#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace stilt::record {

/// Numbers of the ticks received in a run, in order.
class TickLedger {
 public:
  /// Adds ticks `first` to `first + count - 1`; ticks already received are ignored.
  void add(std::uint64_t first, std::uint64_t count);

  [[nodiscard]] bool empty() const { return next_ == 0; }
  /// Number of ticks received.
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Number after the last tick received.
  [[nodiscard]] std::uint64_t next() const { return next_; }

  struct Gap {
    std::uint64_t first = 0, end = 0;  ///< first missing tick, first tick after the gap
  };
  /// Gaps before the last tick, including one at the beginning.
  [[nodiscard]] const std::vector<Gap>& gaps() const { return gaps_; }
  /// Whether ticks are missing between the first and the last one received.
  [[nodiscard]] bool has_break() const { return !gaps_.empty() && gaps_.back().first > 0; }

  /// One sentence: "ticks 0 to 63999, none missing", "..., missing: 0 to 99, 500".
  [[nodiscard]] std::string text() const;
  /// The same without what is missing before the first tick.
  [[nodiscard]] std::string text_of_breaks() const;

 private:
  [[nodiscard]] std::string text(std::span<const Gap> gaps) const;

  std::uint64_t next_ = 0;
  std::uint64_t count_ = 0;
  std::vector<Gap> gaps_;
};

}  // namespace stilt::record
