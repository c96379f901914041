#include "host_tools/benchmark/work_table.h"

namespace stilt::benchmark {
namespace {

/// Work of a second run: the first one may have symbols looked up and pages mapped.
template <class Kernel>
ExecutedWork settled_work(const Kernel& kernel) {
  kernel();
  return count_work(kernel);
}

}  // namespace

template <class Kernel>
ExecutedWork WorkTable::sum_of(Parts& parts, const ocp::Problem& whole, const Kernel& kernel) {
  part_ = whole;
  // A batch is what a second one of the same adds: what is done once, if at all, belongs to no batch.
  const auto added = [&](int& count) {
    count = 1;
    const ExecutedWork one = settled_work(kernel);
    count = 2;
    const ExecutedWork second = settled_work(kernel) - one;
    if (!parts.fixed) parts.fixed = one - second;
    return second;
  };
  ExecutedWork total;
  part_.transition_batches = 0;
  for (int b = 0; b < whole.batches; ++b) {
    const model::ContactMode mode = whole.batch[b].mode;
    const auto [known, is_new] = parts.batch.try_emplace({{mode.left, mode.right}, whole.batch[b].lanes});
    if (is_new) {
      part_.batch[0] = part_.batch[1] = whole.batch[b];
      known->second = added(part_.batches);
    }
    total += known->second;
  }
  part_.batches = 0;
  for (int b = 0; b < whole.transition_batches; ++b) {
    const ocp::TransitionBatch& batch = whole.transition_batch[b];
    const auto [known, is_new] = parts.touchdown.try_emplace({batch.touchdown[0], batch.touchdown[1]});
    if (is_new) {
      part_.transition_batch[0] = part_.transition_batch[1] = batch;
      known->second = added(part_.transition_batches);
    }
    total += known->second;
  }
  total += *parts.fixed;
  return total;
}

ExecutedWork WorkTable::sweep_of(int inputs, const solver::LqStage& stage) {
  const auto [known, is_new] = sweep_.try_emplace(inputs);
  if (is_new) {
    solver::LqGain gain;
    solver::LqStep steps[2];
    alignas(64) const double x0[solver::kRows] = {};
    const auto sweep = [&](int count) {
      return settled_work([&] {
        (void)solver::backward_sweep(&stage, count, linearised_.terminal(), &gain, workspace_);
        solver::forward_sweep(&stage, count, &gain, x0, steps);
      });
    };
    empty_sweep_ = sweep(0);
    known->second = sweep(1) - empty_sweep_;
  }
  return known->second;
}

IterationWork WorkTable::work_of(const control::Planner& planner) {
  const ocp::ProblemData& data = planner.problem_data();
  const ocp::Problem& problem = planner.problem();
  const ocp::Trajectory& iterate = planner.solution();
  IterationWork work;
  work.linearise = sum_of(linearise_, problem, [&] { linearised_.linearise(data, part_, iterate); });
  work.evaluate = sum_of(evaluate_, problem, [&] { (void)ocp::evaluate(data, part_, iterate); });
  linearised_.linearise(data, problem, iterate);
  for (int k = 0; k < problem.horizon.stages; ++k) {
    const solver::LqStage& stage = linearised_.stage(k);
    work.sweep += sweep_of(stage.free_inputs, stage);
  }
  work.sweep += empty_sweep_;
  return work;
}

}  // namespace stilt::benchmark
