#include "mpc_core/ocp/linearise.h"

namespace stilt::ocp {
namespace {

using model::kStates;
using solver::kRows;

/// The places of a batch's stages.
template <class AnyBatch>
BatchModel places(const AnyBatch& batch, solver::LqStage* stages, InputProjection* projections) noexcept {
  BatchModel to;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int k = batch.stage[lane];
    to.first[lane] = stages + k;
    to.second[lane] = stages + k;
    to.inputs[lane] = projections + k;
  }
  return to;
}

}  // namespace

void linearise_terminal(const ProblemData& data, const Problem& problem, const Trajectory& iterate,
                        solver::LqTerminal& terminal) noexcept {
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

void linearise(const ProblemData& data, const Problem& problem, const Trajectory& iterate,
               solver::LqStage* stages, InputProjection* projections, solver::LqTerminal& terminal,
               LineariseWorkspace& work) noexcept {
  for (int first = 0; first < problem.batches;) {
    BatchModel to[kTogether];
    int count = 0;
    while (count < kTogether && first + count < problem.batches &&
           problem.batch[first + count].mode == problem.batch[first].mode) {
      to[count] = places(problem.batch[first + count], stages, projections);
      ++count;
    }
    linearise(data, {problem.batch + first, static_cast<std::size_t>(count)}, iterate, to, work);
    first += count;
  }
  for (int b = 0; b < problem.transition_batches; ++b) {
    const TransitionBatch& batch = problem.transition_batch[b];
    linearise(data, batch, iterate, places(batch, stages, projections), work);
  }
  linearise_terminal(data, problem, iterate, terminal);
}

}  // namespace stilt::ocp
