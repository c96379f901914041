#include "host_tools/benchmark/work_table.h"

#include <algorithm>

namespace stilt::benchmark {
namespace {

/// Work of a second run: the first one can include symbol resolution and page faults.
template <class Kernel>
ExecutedWork settled_work(const Kernel& kernel) {
  kernel();
  return count_work(kernel);
}

}  // namespace

template <class AnyBatch>
void WorkTable::repeat(const ocp::Problem& whole, const AnyBatch& batch, int count, AnyBatch* batches,
                       int& size) {
  const int example = batch.stage[0];
  part_.batches = part_.transition_batches = 0;
  size = count;
  part_.horizon.stages = count * batch.lanes;
  for (int b = 0; b < count; ++b) {
    batches[b] = batch;
    for (int lane = 0; lane < model::kLanes; ++lane) {
      const int k = b * batch.lanes + std::min(lane, batch.lanes - 1);
      batches[b].stage[lane] = k;
      if (lane >= batch.lanes) continue;
      part_.horizon.stage[static_cast<std::size_t>(k)] =
          whole.horizon.stage[static_cast<std::size_t>(example)];
      part_.place[k] = {b, whole.place[example].group, lane};
    }
  }
}

template <class Kernel>
ExecutedWork WorkTable::sum_of(Parts& parts, const ocp::Problem& whole, const Kernel& kernel) {
  part_ = whole;
  // The work of a batch is what a second batch of the same kind adds, so that work done once belongs to no
  // batch.
  const auto added = [&](const auto& batch, auto* batches, int& size) {
    repeat(whole, batch, 1, batches, size);
    const ExecutedWork one = settled_work(kernel);
    repeat(whole, batch, 2, batches, size);
    const ExecutedWork second = settled_work(kernel) - one;
    if (!parts.fixed) parts.fixed = one - second;
    return second;
  };
  ExecutedWork total;
  for (int b = 0; b < whole.batches; ++b) {
    const ocp::StageBatch& batch = whole.batch[b];
    const auto [known, is_new] = parts.batch.try_emplace({{batch.mode.left, batch.mode.right}, batch.lanes});
    if (is_new) known->second = added(batch, part_.batch, part_.batches);
    total += known->second;
  }
  for (int b = 0; b < whole.transition_batches; ++b) {
    const ocp::TransitionBatch& batch = whole.transition_batch[b];
    const auto [known, is_new] =
        parts.touchdown.try_emplace({{batch.touchdown[0], batch.touchdown[1]}, batch.lanes});
    if (is_new) known->second = added(batch, part_.transition_batch, part_.transition_batches);
    total += known->second;
  }
  total += *parts.fixed;
  return total;
}

ExecutedWork WorkTable::sweep_of(const ocp::StageModel& stage, const ocp::InputProjection& inputs) {
  const auto [known, is_new] = sweep_.try_emplace(stage.first.free_inputs);
  if (is_new) {
    lq::LqGain gain;
    lq::LqStep steps[2];
    alignas(64) const double x0[lq::kRows] = {};
    const auto sweep = [&](int count) {
      return settled_work([&] {
        lq::BackwardSweep backward(models_.terminal(), workspace_);
        if (count > 0) (void)backward.step(stage.first, stage.second, gain);
        (void)lq::forward_sweep(&stage.first, &inputs, count, models_.terminal(), &gain, x0, steps);
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
  work.linearise = sum_of(linearise_, problem, [&] { linearise_all(models_, data, part_, iterate); });
  work.evaluate = sum_of(evaluate_, problem, [&] { (void)ocp::evaluate(data, part_, iterate); });
  models_.begin(data, problem, iterate);
  for (int k = problem.horizon.stages - 1; k >= 0; --k) {
    const ocp::StageModel stage = models_.at(k);
    work.sweep += sweep_of(stage, models_.inputs()[k]);
  }
  work.sweep += empty_sweep_;
  return work;
}

}  // namespace stilt::benchmark
