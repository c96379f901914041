#include "mpc_core/dispatch/planner_kernel.h"

#include <new>
#include <type_traits>

#include "mpc_core/control/planner.h"

// Compiled once for each instruction set; STILT_PLANNER_KERNEL is the name of the symbol.
namespace {

using stilt::model::InstructionSet;

constexpr InstructionSet kCompiledFor =
#if defined(__AVX512F__)
    InstructionSet::avx512;
#elif defined(__AVX2__) && defined(__FMA__)
    InstructionSet::avx2;
#elif defined(__SSE2__)
    InstructionSet::sse2;
#elif defined(__ARM_NEON)
    InstructionSet::neon;
#else
#error "the planner has no name for this instruction set"
#endif

static_assert(std::is_trivially_destructible_v<stilt::control::Planner>);
static_assert(sizeof(stilt::control::Planner) <= stilt::dispatch::kPlannerBytes);
static_assert(alignof(stilt::control::Planner) <= stilt::dispatch::kPlannerAlignment);

stilt::control::PlannerInterface* create(void* memory) noexcept {
  return new (memory) stilt::control::Planner;
}

}  // namespace

extern "C" constinit const stilt::dispatch::PlannerKernel STILT_PLANNER_KERNEL{
    kCompiledFor, stilt::dispatch::layout(), create};
