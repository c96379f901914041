#include "firmware/diagnostics/histogram_text.h"

#include <algorithm>
#include <cstdio>

namespace stilt::diagnostics {
namespace {

constexpr double kBarLength = 50;

template <class... Values>
std::string line(const char* format, Values... values) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

std::uint64_t fullest_bin(const Histogram& histogram) {
  std::uint64_t fullest = 0;
  for (std::size_t bin = 0; bin < Histogram::kBins; ++bin) fullest = std::max(fullest, histogram.in_bin(bin));
  return fullest;
}

}  // namespace

std::string to_text(std::string_view name, const Histogram& histogram) {
  const Percentiles p = histogram.percentiles();
  std::string text(name);
  text += line(": %llu, p50 %.4g us, p99 %.4g us, p99.9 %.4g us, max %.4g us",
               static_cast<unsigned long long>(histogram.count()), p.p50_us, p.p99_us, p.p999_us, p.max_us);
  if (histogram.bad() > 0) text += line(", bad %llu", static_cast<unsigned long long>(histogram.bad()));
  text += "\n";
  const double fullest = static_cast<double>(fullest_bin(histogram));
  for (std::size_t bin = 0; bin < Histogram::kBins; ++bin) {
    const std::uint64_t count = histogram.in_bin(bin);
    if (count == 0) continue;
    const auto length = static_cast<std::size_t>(kBarLength * static_cast<double>(count) / fullest);
    text +=
        line("  < %11.4g us %10llu ", Histogram::upper_edge_us(bin), static_cast<unsigned long long>(count));
    text += std::string(std::max<std::size_t>(length, 1), '#') + "\n";
  }
  return text;
}

}  // namespace stilt::diagnostics
