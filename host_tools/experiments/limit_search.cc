#include "host_tools/experiments/limit_search.h"

#include <cmath>

namespace stilt::experiments {

Limit find_limit(const LimitSearch& search, const std::function<bool(double value)>& passes) {
  Limit limit;
  const auto tried = [&](double value) {
    const bool passed = passes(value);
    (passed ? limit.passed : limit.failed) = value;
    return passed;
  };
  const int coarse_steps = static_cast<int>(std::floor(search.largest / search.coarse + 1e-9));
  int failed = 0;
  while (failed <= coarse_steps && tried(failed * search.coarse)) ++failed;
  if (failed == 0 || failed > coarse_steps) return limit;
  int low = 0;  // multiples of fine above the last coarse value that passed
  int high = static_cast<int>(std::lround(search.coarse / search.fine));
  const double base = (failed - 1) * search.coarse;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (tried(base + middle * search.fine) ? low : high) = middle;
  }
  return limit;
}

}  // namespace stilt::experiments
