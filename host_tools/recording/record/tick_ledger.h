#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stilt::record {

/// Which ticks of a run were met, in order.
class TickLedger {
 public:
  /// Ticks `first` to `first + count - 1`; those met already are no news.
  void add(std::uint64_t first, std::uint64_t count);

  [[nodiscard]] bool empty() const { return next_ == 0; }
  /// Ticks met.
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Behind the last tick met.
  [[nodiscard]] std::uint64_t next() const { return next_; }

  struct Gap {
    std::uint64_t first = 0, end = 0;  ///< first missing, first there again
  };
  /// What is missing before the last tick, the beginning included.
  [[nodiscard]] const std::vector<Gap>& gaps() const { return gaps_; }

  /// One sentence: "ticks 0 to 63999, none missing", "..., missing: 0 to 99, 500".
  [[nodiscard]] std::string text() const;

 private:
  std::uint64_t next_ = 0;
  std::uint64_t count_ = 0;
  std::vector<Gap> gaps_;
};

}  // namespace stilt::record
