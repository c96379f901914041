#include "host_tools/benchmark/planner_kernels.h"

#include "mpc_core/lq/riccati.h"

namespace stilt::benchmark {
namespace {

using model::kStates;

/// Prevents the compiler from removing an unused result.
template <class T>
void keep(const T& value) noexcept {
  asm volatile("" : : "r"(&value) : "memory");
}

}  // namespace

const control::Planner* planner_of_build(const dispatch::DispatchedPlanner& planner) noexcept {
  if (planner.instruction_set() != dispatch::instruction_set_of_build()) return nullptr;
  return static_cast<const control::Planner*>(&planner.planner());
}

PlannerKernels::PlannerKernels(const control::Planner& planner)
    : data_(planner.problem_data()),
      problem_(planner.problem()),
      iterate_(planner.solution()),
      linearised_(models_, data_, problem_, iterate_),
      first_orders_(linearised_.first_orders()),
      gains_(static_cast<std::size_t>(stages())),
      steps_(gains_.size() + 1) {}

void PlannerKernels::linearise() { linearise_all(models_, data_, problem_, iterate_); }

void PlannerKernels::linearise_and_sweep() {
  models_.begin(data_, problem_, iterate_);
  lq::BackwardSweep sweep(models_.terminal(), workspace_);
  for (int k = stages() - 1; k >= 0; --k) {
    const ocp::StageModel stage = models_.at(k);
    keep(sweep.step(stage.first, stage.second, gains_[static_cast<std::size_t>(k)]));
  }
  keep(lq::forward_sweep(models_.stages(), models_.inputs(), stages(), models_.terminal(), gains_.data(), x0_,
                         steps_.data()));
}

void PlannerKernels::backward_sweep() {
  lq::BackwardSweep sweep(linearised_.terminal, workspace_);
  for (int k = stages() - 1; k >= 0; --k) {
    const auto i = static_cast<std::size_t>(k);
    keep(sweep.step(linearised_.stages[i], linearised_.stages[i], gains_[i]));
  }
}

void PlannerKernels::sweep() {
  backward_sweep();
  keep(lq::forward_sweep(first_orders_.data(), linearised_.projections.data(), stages(), linearised_.terminal,
                         gains_.data(), x0_, steps_.data()));
}

void PlannerKernels::evaluate() { keep(ocp::evaluate(data_, problem_, iterate_)); }

long long PlannerKernels::textbook_sweep_flops() const noexcept {
  long long sum = 0;
  for (const LqStage& stage : linearised_.stages) sum += benchmark::textbook_sweep_flops(stage.free_inputs);
  return sum;
}

long long textbook_sweep_flops(int free_inputs) noexcept {
  const long long n = kStates;
  const long long m = free_inputs;
  const long long products = 2 * n * n * n + 2 * n * n * m;     // P A, P B
  const long long hessian = n * (n + 1) * n + n * (n + 1) * m;  // Q + A'(P A), - G'H^-1 G: one triangle
  const long long inputs = 2 * n * n * m + n * m * (m + 1);     // G, H
  const long long factor = m * m * m / 3 + 2 * n * m * m;       // L D L', K
  const long long vectors = 2 * n * n + 2 * n * n + 6 * n * m;  // P b + p, h_x, h_u, k, p
  const long long roll_out = 2 * n * n + 4 * n * m;             // A x + B w + b, K x + k
  return products + hessian + inputs + factor + vectors + roll_out;
}

}  // namespace stilt::benchmark
