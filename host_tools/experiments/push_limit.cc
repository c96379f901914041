#include "host_tools/experiments/push_limit.h"

#include <cmath>

namespace stilt::experiments {

PushLimit find_push_limit(const PushSearch& search, const std::function<PushTrial(double)>& attempt) {
  PushLimit limit;
  const auto survives = [&](double force_N) {
    limit.trials.push_back(attempt(force_N));
    if (limit.trials.back().survived) limit.force_N = force_N;
    return limit.trials.back().survived;
  };
  const int coarse_steps = static_cast<int>(std::floor(search.largest_N / search.coarse_N + 1e-9));
  int failed = 0;
  while (failed <= coarse_steps && survives(failed * search.coarse_N)) ++failed;
  if (failed == 0 || failed > coarse_steps) return limit;
  int low = 0;  // multiples of fine_N above the last coarse force that was survived
  int high = static_cast<int>(std::lround(search.coarse_N / search.fine_N));
  const double base_N = (failed - 1) * search.coarse_N;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (survives(base_N + middle * search.fine_N) ? low : high) = middle;
  }
  return limit;
}

}  // namespace stilt::experiments
