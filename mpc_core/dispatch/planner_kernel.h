#pragma once

#include <array>
#include <cstddef>

#include "mpc_core/control/planner_interface.h"

/// The planner as compiled for one instruction set, seen from outside.
namespace stilt::dispatch {

/// Sizes of the types that pass through PlannerInterface. They are the same in all kernels of a program.
using Layout = std::array<std::size_t, 7>;

[[nodiscard]] constexpr Layout layout() noexcept {
  return {sizeof(model::RobotModel),
          sizeof(control::ControllerParameters),
          sizeof(control::PlannerInput),
          sizeof(control::PlannerSettings),
          sizeof(control::Plan),
          sizeof(gait::GaitLibrary),
          sizeof(control::PlannerInterface)};
}

/// Room for the largest planner.
inline constexpr std::size_t kPlannerBytes = 1300 * 1024;
inline constexpr std::size_t kPlannerAlignment = 64;

/// The planner as compiled for one instruction set.
struct PlannerKernel {
  model::InstructionSet instruction_set;
  Layout layout;
  /// Constructs a planner in memory of kPlannerBytes, aligned to kPlannerAlignment. It needs no destructor.
  control::PlannerInterface* (*create)(void* memory) noexcept;
};

}  // namespace stilt::dispatch

// One symbol per kernel, the only one that it shows to the rest of the program.
extern "C" {
/// For the instruction set of the whole build.
extern const stilt::dispatch::PlannerKernel stilt_planner_kernel;
/// Present in builds for AVX2 on x86-64 (STILT_AVX512_KERNEL).
extern const stilt::dispatch::PlannerKernel stilt_planner_kernel_avx512;
}
