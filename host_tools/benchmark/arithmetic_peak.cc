#include "host_tools/benchmark/arithmetic_peak.h"

namespace stilt::benchmark {

double peak_kernel(double factor, double summand) noexcept {
  using model::Batch;
  const Batch a(factor);
  const Batch b(summand);
  Batch sum[kPeakAccumulators];
  for (int i = 0; i < kPeakAccumulators; ++i) sum[i] = Batch(static_cast<double>(i));
  for (int round = 0; round < kPeakRounds; ++round) {
    for (Batch& s : sum) s = s * a + b;
  }
  for (int i = 1; i < kPeakAccumulators; ++i) sum[0] += sum[i];
  return reduce(sum[0]);
}

}  // namespace stilt::benchmark
