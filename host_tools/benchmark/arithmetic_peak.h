#pragma once

#include "mpc_core/model/batch.h"

/// The double-precision arithmetic that one core of this machine delivers, measured: what the phases of the
/// planner are compared with. Only the instruction set this program was built for counts.
namespace stilt::benchmark {

/// Independent sums in flight: enough to cover the latency of a fused multiply-add (4 cycles) on a core that
/// starts two per cycle, few enough to stay in 16 registers.
inline constexpr int kPeakAccumulators = 12;
inline constexpr int kPeakRounds = 4096;

/// Floating-point operations of one peak_kernel(); a fused multiply-add counts as two.
inline constexpr long long kPeakFlops = 2LL * kPeakAccumulators * kPeakRounds * model::kLanes;

/// Fused multiply-adds on full registers, nothing else. `factor` below 1 keeps the sums bounded. Returns
/// their total, so that nothing can be left out.
[[nodiscard]] double peak_kernel(double factor, double summand) noexcept;

}  // namespace stilt::benchmark
