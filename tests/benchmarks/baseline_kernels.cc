#include "tests/benchmarks/baseline_kernels.h"

namespace stilt::benchmark {
namespace {

using model::Batch;
using model::kInputs;
using model::kStates;

/// Keeps the compiler from leaving out an unused result.
template <class T>
void keep(const T& value) noexcept {
  asm volatile("" : : "r"(&value) : "memory");
}

}  // namespace

BaselineKernels::BaselineKernels(const PlannerKernels& kernels)
    : data_(kernels.data()),
      problem_(kernels.problem()),
      iterate_(kernels.iterate()),
      sweep_(kernels.linearised().stages, kernels.linearised().terminal) {}

void BaselineKernels::linearise() {
  for (int b = 0; b < problem_.batches; ++b) {
    const ocp::StageBatch& batch = problem_.batch[b];
    for (int lane = 0; lane < batch.lanes; ++lane) {
      baseline_linearise(data_, batch, lane, iterate_, model_);
      keep(model_);
    }
  }
}

void BaselineKernels::scalar_nodes() {
  model::NodeDerivatives<double> node;
  for (int k = 0; k < problem_.horizon.stages; ++k) {
    if (problem_.horizon.stage[static_cast<std::size_t>(k)].kind != ocp::StageKind::flow) continue;
    data_.robot->node_derivatives(iterate_.x[k], iterate_.u[k], data_.joint_parameters, node);
    keep(node);
  }
}

void BaselineKernels::batched_nodes() {
  model::NodeDerivatives<Batch> node;
  Batch parameters[2 * model::kJoints];
  for (int i = 0; i < 2 * model::kJoints; ++i) parameters[i] = Batch(data_.joint_parameters[i]);
  for (int b = 0; b < problem_.batches; ++b) {
    const ocp::StageBatch& batch = problem_.batch[b];
    Batch x[kStates];
    Batch u[kInputs];
    for (int i = 0; i < kStates; ++i) {
      x[i] = Batch([&](auto lane) { return iterate_.x[batch.stage[lane]][i]; });
    }
    for (int i = 0; i < kInputs; ++i) {
      u[i] = Batch([&](auto lane) { return iterate_.u[batch.stage[lane]][i]; });
    }
    data_.robot->node_derivatives(x, u, parameters, node);
    keep(node);
  }
}

}  // namespace stilt::benchmark
