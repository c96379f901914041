#pragma once

#include <memory>

#include "mpc_core/dispatch/dispatched_planner.h"

namespace stilt::benchmark {

/// A planner in the middle of a walk at 0.5 m/s that follows its own plans: a typical problem, without a
/// simulator.
struct WalkingPlanner {
  /// Ten iterations per plan, no early stop. Throws std::runtime_error when the set is not available or a
  /// plan fails.
  WalkingPlanner(double horizon_s, const model::RobotModel& robot,
                 model::InstructionSet set = dispatch::instruction_set_of_build());

  /// Moves 10 ms along the plan and plans from there.
  sqp::SolveReport plan_next() noexcept;

  std::unique_ptr<dispatch::DispatchedPlanner> planner = std::make_unique<dispatch::DispatchedPlanner>();
  std::unique_ptr<control::Plan> plan = std::make_unique<control::Plan>();
  control::PlannerInput input;
};

}  // namespace stilt::benchmark
