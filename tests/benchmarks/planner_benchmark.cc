#include <benchmark/benchmark.h>

#include <map>
#include <memory>

#include "host_tools/benchmark/interleaved.h"
#include "host_tools/benchmark/planner_kernels.h"
#include "host_tools/benchmark/walking_planner.h"
#include "tests/robots.h"

/// Phases of the planner and the whole plan, on the problem of a walking robot at several horizons, with the
/// plain version of the same work beside them. Argument: horizon, ms. A plain version's counter
/// `times_slower` is its time over that of the version it is compared with, both taken in turns in the same
/// run.
namespace stilt::benchmark {
namespace {

using Kernel = void (PlannerKernels::*)();

double horizon_s(const ::benchmark::State& state) { return 1e-3 * static_cast<double>(state.range(0)); }

PlannerKernels& kernels_for(const ::benchmark::State& state) {
  static std::map<std::int64_t, std::unique_ptr<PlannerKernels>> known;
  std::unique_ptr<PlannerKernels>& kernels = known[state.range(0)];
  if (!kernels)
    kernels = std::make_unique<PlannerKernels>(
        *WalkingPlanner(horizon_s(state), testing_support::amber3m()).planner);
  return *kernels;
}

void run(::benchmark::State& state, Kernel kernel) {
  PlannerKernels& kernels = kernels_for(state);
  for (auto _ : state) {
    (kernels.*kernel)();
    ::benchmark::ClobberMemory();
  }
  state.counters["stages"] = kernels.stages();
}

/// Times `plain`, and the ratio to `fast` over as many turns as it ran.
void run_beside(::benchmark::State& state, Kernel plain, Kernel fast) {
  constexpr int kRounds = 200;
  PlannerKernels& kernels = kernels_for(state);
  run(state, plain);
  const std::vector<double> time_s =
      interleaved_medians_s({[&] { (kernels.*plain)(); }, [&] { (kernels.*fast)(); }}, kRounds);
  state.counters["times_slower"] = time_s[0] / time_s[1];
}

void horizons(::benchmark::internal::Benchmark* bench) {
  bench->ArgName("ms")->Arg(200)->Arg(500)->Arg(1000)->Arg(2000)->Unit(::benchmark::kMicrosecond);
}

void linearise(::benchmark::State& state) { run(state, &PlannerKernels::linearise); }
BENCHMARK(linearise)->Apply(horizons);

void linearise_in_eigen(::benchmark::State& state) {
  run_beside(state, &PlannerKernels::plain_linearise, &PlannerKernels::linearise);
}
BENCHMARK(linearise_in_eigen)->Apply(horizons);

void derivatives_in_batches(::benchmark::State& state) { run(state, &PlannerKernels::batched_nodes); }
BENCHMARK(derivatives_in_batches)->Apply(horizons);

void derivatives_one_by_one(::benchmark::State& state) {
  run_beside(state, &PlannerKernels::scalar_nodes, &PlannerKernels::batched_nodes);
}
BENCHMARK(derivatives_one_by_one)->Apply(horizons);

void evaluate(::benchmark::State& state) { run(state, &PlannerKernels::evaluate); }
BENCHMARK(evaluate)->Apply(horizons);

void riccati(::benchmark::State& state) { run(state, &PlannerKernels::sweep); }
BENCHMARK(riccati)->Apply(horizons);

void riccati_backward(::benchmark::State& state) { run(state, &PlannerKernels::backward_sweep); }
BENCHMARK(riccati_backward)->Apply(horizons);

void riccati_backward_in_eigen(::benchmark::State& state) {
  run_beside(state, &PlannerKernels::plain_sweep, &PlannerKernels::backward_sweep);
}
BENCHMARK(riccati_backward_in_eigen)->Apply(horizons);

/// Ten iterations, warm-started, the robot walking on exactly as planned.
void whole_plan(::benchmark::State& state) {
  WalkingPlanner walking(horizon_s(state), testing_support::amber3m());
  for (auto _ : state) {
    if (!walking.plan_next().usable()) state.SkipWithError("no plan");
  }
}
BENCHMARK(whole_plan)->Apply(horizons);

}  // namespace
}  // namespace stilt::benchmark
