#include "host_tools/experiments/push_limit.h"

#include "host_tools/experiments/limit_search.h"

namespace stilt::experiments {

PushLimit find_push_limit(const PushSearch& search, const std::function<PushTrial(double)>& attempt) {
  PushLimit limit;
  limit.force_N = find_limit({search.coarse_N, search.fine_N, search.largest_N}, [&](double force_N) {
                    limit.trials.push_back(attempt(force_N));
                    return limit.trials.back().survived;
                  }).passed;
  return limit;
}

}  // namespace stilt::experiments
