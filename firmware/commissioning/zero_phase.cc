#include "firmware/commissioning/zero_phase.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace stilt::commissioning {
namespace {

/// y[i] = b0 x[i] + b1 x[i-1] + b2 x[i-2] - a1 y[i-1] - a2 y[i-2]
struct SecondOrder {
  double b0, b1, b2, a1, a2;
};

SecondOrder butterworth(double cutoff_hz, double period_s) {
  const double k = std::tan(std::numbers::pi * cutoff_hz * period_s);
  const double norm = 1 / (1 + std::numbers::sqrt2 * k + k * k);
  return {k * k * norm, 2 * k * k * norm, k * k * norm, 2 * (k * k - 1) * norm,
          (1 - std::numbers::sqrt2 * k + k * k) * norm};
}

void filter(const SecondOrder& f, std::vector<double>& samples) {
  double x1 = samples.front(), x2 = x1, y1 = x1, y2 = x1;
  for (double& sample : samples) {
    const double y = f.b0 * sample + f.b1 * x1 + f.b2 * x2 - f.a1 * y1 - f.a2 * y2;
    x2 = x1;
    x1 = sample;
    y2 = y1;
    y1 = y;
    sample = y;
  }
}

}  // namespace

std::vector<double> zero_phase_filtered(std::span<const double> samples, double cutoff_hz, double period_s) {
  std::vector<double> filtered(samples.begin(), samples.end());
  if (filtered.empty()) return filtered;
  const SecondOrder f = butterworth(cutoff_hz, period_s);
  filter(f, filtered);
  std::ranges::reverse(filtered);
  filter(f, filtered);
  std::ranges::reverse(filtered);
  return filtered;
}

std::vector<double> derivative(std::span<const double> samples, double period_s) {
  std::vector<double> slopes(samples.size());
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    slopes[i] = (samples[i + 1] - samples[i - 1]) / (2 * period_s);
  }
  slopes.front() = slopes[1];
  slopes.back() = slopes[slopes.size() - 2];
  return slopes;
}

}  // namespace stilt::commissioning
