#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace stilt::diagnostics {

/// Percentiles of what a histogram holds, in microseconds.
struct Percentiles {
  double p50_us = 0;
  double p99_us = 0;
  double p999_us = 0;
  double max_us = 0;
};

/// Counts durations in bins fixed at compile time. There are eight of 64 ns, then eight to every factor of
/// two, up to 1.07 s, and one for all above. A percentile is never too low, and too high by an eighth or 64
/// ns at most; count and largest are exact. add_ns() is a few integer operations: real-time. Plain memory:
/// one thread at a time.
class Histogram {
 public:
  static constexpr std::int64_t kUnit_ns = 64;
  static constexpr int kBinsPerOctave = 8;
  static constexpr int kOctaves = 21;
  static constexpr std::size_t kBins = kBinsPerOctave * (kOctaves + 1) + 1;

  /// Adds one duration. A negative one is counted as bad, and as nothing else.
  void add_ns(std::int64_t duration_ns) noexcept;

  /// Upper edge of the first bin up to which at least `fraction` (0 to 1) of the durations lie, at most the
  /// largest duration; 0 without any.
  [[nodiscard]] double percentile_us(double fraction) const noexcept;
  [[nodiscard]] double max_us() const noexcept { return 1e-3 * static_cast<double>(max_ns_); }
  [[nodiscard]] Percentiles percentiles() const noexcept {
    return {percentile_us(0.5), percentile_us(0.99), percentile_us(0.999), max_us()};
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::uint64_t bad() const noexcept { return bad_; }
  [[nodiscard]] std::uint64_t in_bin(std::size_t bin) const noexcept { return bins_[bin]; }

  /// Durations below this, and not below the edge before, are in the bin; infinity for the last.
  [[nodiscard]] static double upper_edge_us(std::size_t bin) noexcept;

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  std::uint64_t bad_ = 0;
  std::int64_t max_ns_ = 0;
};

}  // namespace stilt::diagnostics
