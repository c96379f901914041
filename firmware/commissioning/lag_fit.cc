#include "firmware/commissioning/lag_fit.h"

#include <cmath>
#include <cstddef>

namespace stilt::commissioning {
namespace {

double mean(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Means of products about the means.
struct Moments {
  double reference = 0, signal = 0, both = 0;
};

Moments moments(std::span<const double> reference, std::span<const double> signal) {
  const double reference_mean = mean(reference), signal_mean = mean(signal);
  Moments sum;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double r = reference[i] - reference_mean, s = signal[i] - signal_mean;
    sum.reference += r * r;
    sum.signal += s * s;
    sum.both += r * s;
  }
  const auto count = static_cast<double>(reference.size());
  return {sum.reference / count, sum.signal / count, sum.both / count};
}

}  // namespace

LagFit fit_lag(std::span<const double> reference, std::span<const double> signal, double period_s) {
  const auto most = static_cast<std::size_t>(std::lround(kLargestDelay_s / period_s));
  LagFit best;
  if (reference.size() != signal.size() || reference.size() <= 2 * most + 1) return best;
  const std::size_t count = reference.size() - 2 * most;
  const std::span<const double> middle = signal.subspan(most, count);
  for (std::size_t shift = 0; shift <= 2 * most; ++shift) {
    const Moments at = moments(reference.subspan(shift, count), middle);
    const double explained = at.both * at.both / (at.reference * at.signal);
    if (!(explained > best.explained)) continue;  // also where one of them does not move
    const double delay_s = (static_cast<double>(most) - static_cast<double>(shift)) * period_s;
    best = {.gain = at.both / at.reference, .delay_s = delay_s, .explained = explained};
  }
  const Moments all = moments(reference, signal);
  best.reference_spread = std::sqrt(all.reference);
  best.signal_spread = std::sqrt(all.signal);
  return best;
}

std::vector<double> detrended(std::span<const double> values) {
  std::vector<double> result(values.begin(), values.end());
  if (values.empty()) return result;
  const double value_mean = mean(values);
  const double index_mean = 0.5 * static_cast<double>(values.size() - 1);
  double both = 0, squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double from_mean = static_cast<double>(i) - index_mean;
    both += from_mean * (values[i] - value_mean);
    squares += from_mean * from_mean;
  }
  const double slope = squares > 0 ? both / squares : 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] -= value_mean + slope * (static_cast<double>(i) - index_mean);
  }
  return result;
}

double spread(std::span<const double> values) {
  return values.empty() ? 0 : std::sqrt(moments(values, values).reference);
}

}  // namespace stilt::commissioning
