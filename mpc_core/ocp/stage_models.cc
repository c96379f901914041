#include "mpc_core/ocp/stage_models.h"

#include <algorithm>

#include "mpc_core/model/debug_assert.h"

namespace stilt::ocp {
namespace {

using lq::kRows;
using model::kStates;

/// Writes 1/2 (x - x_ref)' W (x - x_ref) around the last state of the iterate.
void write_terminal(const ProblemData& data, const Problem& problem, const Trajectory& iterate,
                    lq::LqTerminal& terminal) noexcept {
  const double* x = iterate.x[problem.horizon.stages];
  for (int c = 0; c < kStates; ++c) {
    double product = 0.0;
    for (int r = 0; r < kRows; ++r) {
      terminal.Q[c][r] = data.terminal_weight[c][r];
      if (r < kStates) product += data.terminal_weight[c][r] * (x[r] - problem.x_ref_terminal[r]);
    }
    terminal.q[c] = product;
  }
  for (int r = kStates; r < kRows; ++r) terminal.q[r] = 0.0;
}

}  // namespace

void StageModels::begin(const ProblemData& data, const Problem& problem, const Trajectory& iterate) noexcept {
  data_ = &data;
  problem_ = &problem;
  iterate_ = &iterate;
  linearising_ns_ = 0;
  std::fill(std::begin(linearised_from_), std::end(linearised_from_), kMaxBatches);
  write_terminal(data, problem, iterate, terminal_);
}

template <class AnyBatch>
BatchModel StageModels::output_of(const AnyBatch& batch, int group, int index) noexcept {
  BatchModel to;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int k = batch.stage[lane];
    to.first[lane] = stages_ + k;
    to.second[lane] = hessians(group, index) + std::min(lane, batch.lanes - 1);
    to.inputs[lane] = projections_ + k;
  }
  return to;
}

void StageModels::linearise_group(int k) noexcept {
  STILT_ASSERT(k >= 0 && k < problem_->horizon.stages);
  if (clock_ == nullptr) return linearise_batches(k);
  const long long start_ns = clock_();
  linearise_batches(k);
  linearising_ns_ += clock_() - start_ns;
}

void StageModels::linearise_batches(int k) noexcept {
  const auto [last, group, lane] = problem_->place[k];
  if (problem_->horizon.stage[k].kind == StageKind::transition) {
    const TransitionBatch& batch = problem_->transition_batch[last];
    linearise(*data_, batch, *iterate_, output_of(batch, group, last));
    linearised_from_[group] = last;
    return;
  }
  const StageBatch* batches = problem_->batch;
  int first = last;
  while (first > 0 && last - first + 1 < kBatchesPerGroup && batches[first - 1].mode == batches[last].mode)
    --first;
  BatchModel to[kBatchesPerGroup];
  for (int b = first; b <= last; ++b) to[b - first] = output_of(batches[b], group, b);
  linearise(*data_, {batches + first, static_cast<std::size_t>(last - first + 1)}, *iterate_, to, work_);
  linearised_from_[group] = first;
}

}  // namespace stilt::ocp
