#pragma once

#include "mpc_core/model/batch.h"

/// Measures the double-precision arithmetic that one core of this machine delivers, the reference for the
/// phases of the planner. Only instructions of the instruction set of this build are used.
namespace stilt::benchmark {

/// Independent sums. They are enough to cover the latency of a fused multiply-add (4 cycles) on a core that
/// starts two per cycle. They are few enough to stay in 16 registers.
inline constexpr int kPeakAccumulators = 12;
inline constexpr int kPeakRounds = 4096;

/// Floating-point operations of one peak_kernel(); a fused multiply-add counts as two.
inline constexpr long long kPeakFlops = 2LL * kPeakAccumulators * kPeakRounds * model::kLanes;

/// Executes fused multiply-adds on full registers only. A `factor` below 1 keeps the sums bounded. Returns
/// their total, so that the compiler can remove none.
[[nodiscard]] double peak_kernel(double factor, double summand) noexcept;

}  // namespace stilt::benchmark
