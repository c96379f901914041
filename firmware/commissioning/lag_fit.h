#pragma once

#include <span>
#include <vector>

/// How a signal follows another: gain and delay. Pure.
namespace stilt::commissioning {

/// signal(t) = gain reference(t - delay_s) + constant
struct LagFit {
  double gain = 0.0;
  double delay_s = 0.0;
  double explained = 0.0;         ///< share of the signal's variance, 1 where the equation holds
  double reference_spread = 0.0;  ///< standard deviation
  double signal_spread = 0.0;
};

inline constexpr double kLargestDelay_s = 0.1;

/// Least squares over gain and constant for each delay of whole samples within kLargestDelay_s either way;
/// the delay with the smallest residual counts.
/// @param reference, signal  as many samples of each, period_s apart; more than two kLargestDelay_s
[[nodiscard]] LagFit fit_lag(std::span<const double> reference, std::span<const double> signal,
                             double period_s);

/// The values without their least-squares line over the index: what the integral of a biased rate needs.
[[nodiscard]] std::vector<double> detrended(std::span<const double> values);

/// Standard deviation; 0 without values.
[[nodiscard]] double spread(std::span<const double> values);

}  // namespace stilt::commissioning
