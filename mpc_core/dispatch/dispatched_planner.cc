#include "mpc_core/dispatch/dispatched_planner.h"

namespace stilt::dispatch {
namespace {

using model::InstructionSet;

#ifdef STILT_AVX512_KERNEL
constexpr const PlannerKernel* kAvx512 = &stilt_planner_kernel_avx512;

/// What -march=x86-64-v4 uses beyond x86-64-v3, and whether the system saves its registers.
bool processor_has_avx512() noexcept {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512cd") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
         __builtin_cpu_supports("avx512vl") != 0;
}

/// Whether it plans more often with them than with AVX2. The only AVX-512 of AMD's family 19h is Zen 4, which
/// carries out 512-bit operations in two halves (docs/speed.md, AVX-512).
bool processor_gains_by_avx512() noexcept {
  return processor_has_avx512() && __builtin_cpu_is("amdfam19h") == 0;
}
#else
constexpr const PlannerKernel* kAvx512 = nullptr;

bool processor_has_avx512() noexcept { return false; }

bool processor_gains_by_avx512() noexcept { return false; }
#endif

/// The kernel for it; null when program or processor has none.
const PlannerKernel* kernel_for(InstructionSet set) noexcept {
  // The program runs, so the processor has what the whole of it was compiled for.
  if (set == stilt_planner_kernel.instruction_set) return &stilt_planner_kernel;
  if (set == InstructionSet::avx512 && processor_has_avx512()) return kAvx512;
  return nullptr;
}

}  // namespace

InstructionSet instruction_set_of_build() noexcept { return stilt_planner_kernel.instruction_set; }

bool available(InstructionSet set) noexcept { return kernel_for(set) != nullptr; }

std::optional<InstructionSet> choose(InstructionSet wanted) noexcept {
  if (wanted == InstructionSet::automatic) {
    return processor_gains_by_avx512() ? InstructionSet::avx512 : instruction_set_of_build();
  }
  if (!available(wanted)) return std::nullopt;
  return wanted;
}

DispatchedPlanner::DispatchedPlanner() noexcept { create(*choose(InstructionSet::automatic)); }

void DispatchedPlanner::create(InstructionSet set) noexcept {
  const PlannerKernel& kernel = *kernel_for(set);
  instruction_set_ = set;
  planner_ = kernel.create(memory_);
}

control::ConfigureStatus DispatchedPlanner::configure(
    const model::RobotModel& robot, const control::ControllerParameters& parameters) noexcept {
  const std::optional<InstructionSet> set = choose(parameters.sqp.instruction_set);
  if (!set) return control::ConfigureStatus::no_such_instructions;
  if (*set != instruction_set_) create(*set);
  return planner_->configure(robot, parameters);
}

}  // namespace stilt::dispatch
