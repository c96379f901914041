#pragma once

#include <span>
#include <vector>

namespace stilt::commissioning {

/// A Butterworth low-pass filter of second order, forward and then backward: no delay, the gain of the fourth
/// order. The bilinear transform with prewarping gives its coefficients; each pass starts settled at its
/// first sample. The ends, about 1 / cutoff_hz long, are not to be trusted. Allocates; not for real time.
/// Source: Gustafsson 1996, Determining the initial states in forward-backward filtering, on such filters.
[[nodiscard]] std::vector<double> zero_phase_filtered(std::span<const double> samples, double cutoff_hz,
                                                      double period_s);

/// Central differences; the ends repeat their neighbours. At least three samples.
[[nodiscard]] std::vector<double> derivative(std::span<const double> samples, double period_s);

}  // namespace stilt::commissioning
