#include <benchmark/benchmark.h>

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "host_tools/benchmark/interleaved.h"
#include "host_tools/benchmark/planner_kernels.h"
#include "host_tools/benchmark/walking_planner.h"
#include "tests/benchmarks/baseline_kernels.h"
#include "tests/robots.h"

/// Phases of the planner and the whole plan, on the problem of a walking robot at several horizons. The
/// baseline of the same work stands beside them. Argument: horizon, ms. A baseline's counter `times_slower`
/// is its time over that of the version it is compared with, both taken in turns in the same run.
namespace stilt::benchmark {
namespace {

/// Both versions of the kernels on one problem.
struct Versions {
  PlannerKernels fast;
  BaselineKernels baseline;
};
using Kernel = std::function<void(Versions&)>;

double horizon_s(const ::benchmark::State& state) { return 1e-3 * static_cast<double>(state.range(0)); }

Versions& versions_for(const ::benchmark::State& state) {
  static std::map<std::int64_t, std::unique_ptr<Versions>> known;
  std::unique_ptr<Versions>& versions = known[state.range(0)];
  if (!versions) {
    const WalkingPlanner walking(horizon_s(state), testing_support::amber3m());
    const auto kernels = std::make_unique<PlannerKernels>(*planner_of_build(*walking.planner));
    versions = std::make_unique<Versions>(*kernels, BaselineKernels(*kernels));
  }
  return *versions;
}

void run(::benchmark::State& state, const Kernel& kernel) {
  Versions& versions = versions_for(state);
  for (auto _ : state) {
    kernel(versions);
    ::benchmark::ClobberMemory();
  }
  state.counters["stages"] = versions.fast.stages();
}

/// Times `baseline`, and the ratio to `fast` over as many turns as it ran.
void run_beside(::benchmark::State& state, const Kernel& baseline, const Kernel& fast) {
  constexpr int kRounds = 200;
  Versions& versions = versions_for(state);
  run(state, baseline);
  const std::vector<double> time_s =
      interleaved_medians_s({[&] { baseline(versions); }, [&] { fast(versions); }}, kRounds);
  state.counters["times_slower"] = time_s[0] / time_s[1];
}

void horizons(::benchmark::internal::Benchmark* bench) {
  bench->ArgName("ms")->Arg(200)->Arg(500)->Arg(1000)->Arg(2000)->Unit(::benchmark::kMicrosecond);
}

void linearise(::benchmark::State& state) {
  run(state, [](Versions& on) { on.fast.linearise(); });
}
BENCHMARK(linearise)->Apply(horizons);

void linearise_in_eigen(::benchmark::State& state) {
  run_beside(state, [](Versions& on) { on.baseline.linearise(); }, [](Versions& on) { on.fast.linearise(); });
}
BENCHMARK(linearise_in_eigen)->Apply(horizons);

void derivatives_in_batches(::benchmark::State& state) {
  run(state, [](Versions& on) { on.baseline.batched_nodes(); });
}
BENCHMARK(derivatives_in_batches)->Apply(horizons);

void derivatives_one_by_one(::benchmark::State& state) {
  run_beside(
      state, [](Versions& on) { on.baseline.scalar_nodes(); },
      [](Versions& on) { on.baseline.batched_nodes(); });
}
BENCHMARK(derivatives_one_by_one)->Apply(horizons);

void evaluate(::benchmark::State& state) {
  run(state, [](Versions& on) { on.fast.evaluate(); });
}
BENCHMARK(evaluate)->Apply(horizons);

void riccati(::benchmark::State& state) {
  run(state, [](Versions& on) { on.fast.sweep(); });
}
BENCHMARK(riccati)->Apply(horizons);

void riccati_backward(::benchmark::State& state) {
  run(state, [](Versions& on) { on.fast.backward_sweep(); });
}
BENCHMARK(riccati_backward)->Apply(horizons);

void riccati_backward_in_eigen(::benchmark::State& state) {
  run_beside(
      state, [](Versions& on) { on.baseline.sweep(); }, [](Versions& on) { on.fast.backward_sweep(); });
}
BENCHMARK(riccati_backward_in_eigen)->Apply(horizons);

/// Ten iterations, warm-started, the robot walking on exactly as planned.
void whole_plan(::benchmark::State& state, model::InstructionSet set) {
  WalkingPlanner walking(horizon_s(state), testing_support::amber3m(), set);
  for (auto _ : state) {
    if (!walking.plan_next().usable()) state.SkipWithError("no plan");
  }
}

/// One for each instruction set that program and processor have.
[[maybe_unused]] const bool kWholePlans = [] {
  using enum model::InstructionSet;
  for (const model::InstructionSet set : {sse2, avx2, avx512, neon}) {
    if (!dispatch::available(set)) continue;
    const std::string name = "whole_plan/" + std::string(model::name_of(set));
    ::benchmark::RegisterBenchmark(name.c_str(), whole_plan, set)->Apply(horizons);
  }
  return true;
}();

}  // namespace
}  // namespace stilt::benchmark
