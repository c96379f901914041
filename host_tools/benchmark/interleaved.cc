#include "host_tools/benchmark/interleaved.h"

#include <algorithm>
#include <chrono>

namespace stilt::benchmark {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> interleaved_medians_s(const std::vector<std::function<void()>>& kernels, int rounds) {
  using Clock = std::chrono::steady_clock;
  std::vector<std::vector<double>> times(kernels.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < kernels.size(); ++i) {
      kernels[i]();
      const Clock::time_point start = Clock::now();
      kernels[i]();
      times[i].push_back(std::chrono::duration<double>(Clock::now() - start).count());
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& list : times) medians.push_back(median(std::move(list)));
  return medians;
}

}  // namespace stilt::benchmark
