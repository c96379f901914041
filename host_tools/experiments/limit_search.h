#pragma once

#include <functional>
#include <optional>

namespace stilt::experiments {

/// Values of one quantity to try, from 0 on, in its unit. All three have the same sign; when negative, the
/// search goes down.
struct LimitSearch {
  double coarse = 1.0;   ///< the search tries its multiples until one fails
  double fine = 0.1;     ///< resolution of the limit; divides coarse
  double largest = 1.0;  ///< largest value to try
};

/// Result of find_limit().
struct Limit {
  /// The value farthest from 0 that passed, such that every tried value before it passed too; nothing when 0
  /// fails.
  std::optional<double> passed;
  /// The value nearest to 0 that failed; nothing when all values up to the largest pass.
  std::optional<double> failed;
};

/// Finds the limit. Passing need not be monotone in the value. The search tries all multiples of coarse from
/// 0 up to the first that fails. It then halves the interval below that one to a width of fine.
[[nodiscard]] Limit find_limit(const LimitSearch& search, const std::function<bool(double value)>& passes);

}  // namespace stilt::experiments
