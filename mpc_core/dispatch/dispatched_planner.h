#pragma once

#include <optional>

#include "mpc_core/dispatch/planner_kernel.h"

/// Choice of the planner among those that are linked into this program, each for one instruction set
/// (docs/decisions/0023-instruction-sets.md).
namespace stilt::dispatch {

/// The instruction set that the rest of this program is compiled for.
[[nodiscard]] model::InstructionSet instruction_set_of_build() noexcept;

/// Whether this program has a planner for it and this processor the instructions. Not for `automatic`.
[[nodiscard]] bool available(model::InstructionSet set) noexcept;

/// What `wanted` stands for on this processor: `automatic` is AVX-512 where that plans more often, otherwise
/// instruction_set_of_build(). Nothing when program or processor lacks it.
[[nodiscard]] std::optional<model::InstructionSet> choose(model::InstructionSet wanted) noexcept;

/// A planner for the instruction set that its parameters choose. Fixed size, no heap.
class DispatchedPlanner {
 public:
  /// The planner for the best instruction set.
  DispatchedPlanner() noexcept;
  DispatchedPlanner(const DispatchedPlanner&) = delete;
  DispatchedPlanner& operator=(const DispatchedPlanner&) = delete;

  /// Takes the planner for parameters.sqp.instruction_set, a new one if it was another, and configures it.
  /// Takes milliseconds, not real-time safe.
  [[nodiscard]] control::ConfigureStatus configure(const model::RobotModel& robot,
                                                   const control::ControllerParameters& parameters) noexcept;

  [[nodiscard]] model::InstructionSet instruction_set() const noexcept { return instruction_set_; }
  [[nodiscard]] control::PlannerInterface& planner() noexcept { return *planner_; }
  [[nodiscard]] const control::PlannerInterface& planner() const noexcept { return *planner_; }

 private:
  void create(model::InstructionSet set) noexcept;

  model::InstructionSet instruction_set_;
  control::PlannerInterface* planner_;
  alignas(kPlannerAlignment) std::byte memory_[kPlannerBytes];
};

}  // namespace stilt::dispatch
