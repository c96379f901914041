#include <benchmark/benchmark.h>

#include <vector>

#include "mpc_core/lq/care.h"
#include "mpc_core/lq/riccati.h"
#include "tests/benchmarks/baseline_sweep.h"
#include "tests/mpc_core/lq/random_lq.h"

/// The Riccati sweep against the same recursion in fixed-size Eigen, on the same data in the same run: 134
/// stages (2 s at 15 ms), 14 states. Arguments: the kind of every stage, an index into
/// testing::kKinds.
namespace stilt::lq {
namespace {

constexpr int kStages = 134;

testing::LqProblem problem_with(const testing::StageKind& kind) {
  testing::LqProblem problem = testing::random_problem(1, 0);
  std::mt19937_64 random(2);
  for (int k = 0; k < kStages; ++k) testing::add_stage(random, kind, 0.05, problem);
  return problem;
}

/// A walk's pattern: single support, now and then 3 stages of double support and a transition without inputs.
testing::LqProblem walking_problem() {
  testing::LqProblem problem = testing::random_problem(1, 0);
  std::mt19937_64 random(2);
  for (int k = 0; k < kStages; ++k) {
    const int phase = k % 27;
    const testing::StageKind& kind = phase == 26   ? testing::kTransition
                                     : phase >= 23 ? testing::kDoubleSupport
                                                   : testing::kSingleSupport;
    testing::add_stage(random, kind, 0.05, problem);
  }
  return problem;
}

void run_backward(::benchmark::State& state, const testing::LqProblem& problem) {
  std::vector<LqGain> gains(problem.stages.size());
  RiccatiWorkspace workspace;
  for (auto _ : state) {
    const testing::SweepStatus status = testing::backward_sweep(problem, gains.data(), workspace);
    if (!status.ok()) state.SkipWithError("sweep failed");
    ::benchmark::DoNotOptimize(gains.data());
    ::benchmark::ClobberMemory();
  }
}

void BM_backward(::benchmark::State& state) {
  run_backward(state, problem_with(testing::kKinds[state.range(0)]));
}
BENCHMARK(BM_backward)->ArgName("kind")->DenseRange(0, 3)->Unit(::benchmark::kMicrosecond);

void BM_backward_walking(::benchmark::State& state) { run_backward(state, walking_problem()); }
BENCHMARK(BM_backward_walking)->Unit(::benchmark::kMicrosecond);

void BM_forward_walking(::benchmark::State& state) {
  const testing::LqProblem problem = walking_problem();
  testing::SweepStatus status;
  testing::LqSolution solution = testing::solve(problem, status);
  const std::vector<LqFirstOrder> stages = problem.first_orders();
  for (auto _ : state) {
    ::benchmark::DoNotOptimize(forward_sweep(stages.data(), problem.inputs.data(), kStages, problem.terminal,
                                             solution.gains.data(), problem.x0, solution.steps.data()));
    ::benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_forward_walking)->Unit(::benchmark::kMicrosecond);

/// The textbook recursion in fixed-size Eigen.
void BM_backward_eigen(::benchmark::State& state) {
  const testing::LqProblem problem = problem_with(testing::kKinds[state.range(0)]);
  stilt::benchmark::BaselineSweep sweep(problem.stages, problem.terminal);
  for (auto _ : state) {
    sweep.run();
    ::benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_backward_eigen)->ArgName("kind")->DenseRange(0, 3)->Unit(::benchmark::kMicrosecond);

void BM_care(::benchmark::State& state) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  CareProblem problem{StateMatrix::NullaryExpr([&] { return normal(random); }),
                      InputMatrix::NullaryExpr([&] { return normal(random); }), StateMatrix::Identity(),
                      InputWeight::Identity()};
  CareSolution solution;
  CareWorkspace workspace;
  for (auto _ : state) {
    if (solve_care(problem, solution, workspace) != CareOutcome::ok) state.SkipWithError("no solution");
  }
}
BENCHMARK(BM_care)->Unit(::benchmark::kMicrosecond);

}  // namespace
}  // namespace stilt::lq
