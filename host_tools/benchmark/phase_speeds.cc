#include "host_tools/benchmark/phase_speeds.h"

#include "host_tools/benchmark/arithmetic_peak.h"
#include "host_tools/benchmark/interleaved.h"

namespace stilt::benchmark {
namespace {

PhaseSpeed speed_of(double time_s, const ExecutedWork& work, double peak_gflop_s) {
  const double rate_gflop_s = 1e-9 * static_cast<double>(work.flops) / time_s;
  return {1e6 * time_s, work, rate_gflop_s, rate_gflop_s / peak_gflop_s};
}

}  // namespace

PhaseSpeeds measure_phases(PlannerKernels& kernels, const IterationWork& work, int rounds) {
  volatile double factor = 0.5;
  volatile double sink = 0.0;
  const std::vector<double> time_s =
      interleaved_medians_s({[&] { sink = peak_kernel(factor, 1.0); }, [&] { kernels.linearise(); },
                             [&] { kernels.linearise_and_sweep(); }, [&] { kernels.evaluate(); }},
                            rounds);
  const double sweep_s = time_s[2] - time_s[1];
  PhaseSpeeds speeds;
  speeds.peak_gflop_s = 1e-9 * static_cast<double>(kPeakFlops) / time_s[0];
  speeds.linearise = speed_of(time_s[1], work.linearise, speeds.peak_gflop_s);
  speeds.sweep = speed_of(sweep_s, work.sweep, speeds.peak_gflop_s);
  speeds.evaluate = speed_of(time_s[3], work.evaluate, speeds.peak_gflop_s);
  speeds.textbook_sweep_share =
      1e-9 * static_cast<double>(kernels.textbook_sweep_flops()) / sweep_s / speeds.peak_gflop_s;
  return speeds;
}

}  // namespace stilt::benchmark
