#include "host_tools/simulation/plant/number.h"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace stilt::simulation {

std::optional<double> parse_number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string number_text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

std::string decimals_text(double value, std::size_t least) {
  constexpr int kMost = 12;
  constexpr double kSmallest = 0.5e-12;  // no -0.00
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, "%.*f", kMost, std::abs(value) < kSmallest ? 0.0 : value);
  std::string text = buffer;
  const std::size_t shortest = text.find('.') + 1 + least;
  while (text.size() > shortest && text.back() == '0') text.pop_back();
  return text;
}

}  // namespace stilt::simulation
