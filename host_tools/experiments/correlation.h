#pragma once

#include <optional>
#include <span>

/// Shares and correlations with their 95 % confidence intervals.
namespace stilt::experiments {

struct Interval {
  double low = 0.0, high = 0.0;
};

/// An estimate and its interval.
struct Estimate {
  double value = 0.0;
  Interval interval;
};

/// Wilson's score interval (1927) of a share, from `successes` of `cases` independent cases. `cases` must be
/// positive.
[[nodiscard]] Estimate share(int successes, int cases);

/// Product-moment correlation r of two samples of equal length n. Its interval is tanh(atanh r +- 1.96 /
/// sqrt(n - 3)), Fisher's. With a sample of zeros and ones it is the point-biserial correlation. Nothing when
/// a sample is constant, or with fewer than four pairs.
[[nodiscard]] std::optional<Estimate> correlation(std::span<const double> x, std::span<const double> y);

/// Spearman's rank correlation rho: correlation() of the ranks, equal values sharing their mean rank. In the
/// interval 1 is replaced by sqrt(1 + rho^2 / 2), as Bonett and Wright (2000) found.
[[nodiscard]] std::optional<Estimate> rank_correlation(std::span<const double> x, std::span<const double> y);

}  // namespace stilt::experiments
