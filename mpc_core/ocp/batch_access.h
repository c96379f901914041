#pragma once

#include "mpc_core/ocp/problem.h"
#include "mpc_core/ocp/projection.h"

/// Moving numbers between per-stage rows and batches.
namespace stilt::ocp {

/// Lane i takes rows[stage[i] + offset][column].
template <std::size_t Columns>
[[nodiscard]] inline Batch gather(const double (*rows)[Columns], const StageBatch& batch, int column,
                                  int offset = 0) noexcept {
  return Batch([&](auto lane) { return rows[batch.stage[lane] + offset][column]; });
}

/// States and inputs of a batch of stages, and the states at their ends.
struct BatchIterate {
  Batch x[model::kStates];
  Batch u[model::kInputs];
  Batch x_next[model::kStates];

  BatchIterate(const Trajectory& iterate, const StageBatch& batch) noexcept {
    for (int i = 0; i < model::kStates; ++i) {
      x[i] = gather(iterate.x, batch, i);
      x_next[i] = gather(iterate.x, batch, i, 1);
    }
    for (int i = 0; i < model::kInputs; ++i) u[i] = gather(iterate.u, batch, i);
  }
};

/// The robot's armature and damping, broadcast.
struct BatchParameters {
  Batch value[2 * model::kJoints];

  explicit BatchParameters(const ProblemData& data) noexcept {
    for (int i = 0; i < 2 * model::kJoints; ++i) value[i] = Batch(data.joint_parameters[i]);
  }
};

/// Calls `kernel(ModeTraits<...>{})` for the batch's contact mode.
template <class Kernel>
void dispatch(const model::ContactMode& mode, Kernel&& kernel) noexcept {
  if (mode.left && mode.right) {
    kernel(ModeTraits<true, true>{});
  } else if (mode.left) {
    kernel(ModeTraits<true, false>{});
  } else if (mode.right) {
    kernel(ModeTraits<false, true>{});
  } else {
    kernel(ModeTraits<false, false>{});
  }
}

}  // namespace stilt::ocp
