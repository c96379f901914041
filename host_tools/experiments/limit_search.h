#pragma once

#include <functional>
#include <optional>

namespace stilt::experiments {

/// How the values of one quantity are tried, from 0 on, in its own unit. All three of one sign: below 0, the
/// search goes down.
struct LimitSearch {
  double coarse = 1.0;   ///< every multiple of it is tried until one fails
  double fine = 0.1;     ///< the limit is found to this; divides coarse
  double largest = 1.0;  ///< no value beyond it is tried
};

struct Limit {
  /// The value farthest from 0 that passed, with every one before it that was tried passed, too; nothing when
  /// 0 fails.
  std::optional<double> passed;
  /// The value nearest to 0 that failed; nothing when all up to the largest pass.
  std::optional<double> failed;
};

/// Whether a value passes need not be monotone: all multiples of coarse are tried from 0 up to the first that
/// fails, then the interval below that one is halved until it is fine wide.
[[nodiscard]] Limit find_limit(const LimitSearch& search, const std::function<bool(double value)>& passes);

}  // namespace stilt::experiments
