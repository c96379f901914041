#include "firmware/diagnostics/histogram.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace stilt::diagnostics {
namespace {

/// Units below 8 have a bin each; from there the three bits behind the leading one choose the bin.
std::size_t bin_of(std::uint64_t units) noexcept {
  constexpr std::uint64_t kPerOctave = Histogram::kBinsPerOctave;
  if (units < kPerOctave) return units;
  const auto octave = std::bit_width(units) - std::bit_width(kPerOctave);
  const std::uint64_t bin = kPerOctave * octave + (units >> octave);
  return std::min<std::uint64_t>(bin, Histogram::kBins - 1);
}

}  // namespace

void Histogram::add_ns(std::int64_t duration_ns) noexcept {
  if (duration_ns < 0) {
    ++bad_;
    return;
  }
  ++bins_[bin_of(static_cast<std::uint64_t>(duration_ns / kUnit_ns))];
  ++count_;
  max_ns_ = std::max(max_ns_, duration_ns);
}

double Histogram::upper_edge_us(std::size_t bin) noexcept {
  constexpr std::size_t kPerOctave = kBinsPerOctave;
  if (bin + 1 >= kBins) return std::numeric_limits<double>::infinity();
  const std::size_t octave = bin < kPerOctave ? 0 : bin / kPerOctave - 1;
  const std::uint64_t units = std::uint64_t{bin - kPerOctave * octave + 1} << octave;
  return 1e-3 * static_cast<double>(units) * static_cast<double>(kUnit_ns);
}

double Histogram::percentile_us(double fraction) const noexcept {
  const double wanted = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(count_);
  std::uint64_t sum = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    sum += bins_[bin];
    if (sum > 0 && static_cast<double>(sum) >= wanted) return std::min(upper_edge_us(bin), max_us());
  }
  return 0;
}

}  // namespace stilt::diagnostics
