#include "host_tools/experiments/correlation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace stilt::experiments {
namespace {

constexpr double kQuantile = 1.959963984540054;  // of the normal distribution, at 0.975

/// Fisher's interval of a correlation of n pairs, for a standard deviation of `factor` / sqrt(n - 3).
Estimate with_interval(double r, std::size_t n, double factor) {
  const double half = kQuantile * factor / std::sqrt(static_cast<double>(n) - 3.0);
  return {r, {std::tanh(std::atanh(r) - half), std::tanh(std::atanh(r) + half)}};
}

/// Correlation without interval; nothing when it is undefined.
std::optional<double> product_moment(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  const double mean_x = std::reduce(x.begin(), x.end()) / n;
  const double mean_y = std::reduce(y.begin(), y.end()) / n;
  double xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  if (x.size() < 4 || xx == 0.0 || yy == 0.0) return std::nullopt;
  return std::clamp(xy / std::sqrt(xx * yy), -1.0, 1.0);
}

/// The rank of each value, from 1; equal values share their mean rank.
std::vector<double> ranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> rank(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first;
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    for (std::size_t i = first; i < end; ++i) rank[order[i]] = 0.5 * static_cast<double>(first + end + 1);
    first = end;
  }
  return rank;
}

}  // namespace

Estimate share(int successes, int cases) {
  const double n = cases;
  const double p = successes / n;
  const double z2 = kQuantile * kQuantile;
  const double centre = (p + 0.5 * z2 / n) / (1.0 + z2 / n);
  const double half = kQuantile / (1.0 + z2 / n) * std::sqrt((p * (1.0 - p) + 0.25 * z2 / n) / n);
  return {p, {std::max(0.0, centre - half), std::min(1.0, centre + half)}};
}

std::optional<Estimate> correlation(std::span<const double> x, std::span<const double> y) {
  const auto r = product_moment(x, y);
  return r ? std::optional(with_interval(*r, x.size(), 1.0)) : std::nullopt;
}

std::optional<Estimate> rank_correlation(std::span<const double> x, std::span<const double> y) {
  const auto rho = product_moment(ranks(x), ranks(y));
  return rho ? std::optional(with_interval(*rho, x.size(), std::sqrt(1.0 + 0.5 * *rho * *rho)))
             : std::nullopt;
}

}  // namespace stilt::experiments
