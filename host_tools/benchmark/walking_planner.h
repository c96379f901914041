#pragma once

#include <memory>

#include "mpc_core/control/planner.h"

namespace stilt::benchmark {

/// A planner in the middle of a walk at 0.5 m/s that follows its own plans: a typical problem, without a
/// simulator.
struct WalkingPlanner {
  /// Ten iterations per plan, no early stop. Throws std::runtime_error when a plan fails.
  explicit WalkingPlanner(double horizon_s, const model::RobotModel& robot);

  /// Moves 10 ms along the plan and plans from there.
  sqp::SolveReport plan_next() noexcept;

  std::unique_ptr<control::Planner> planner = std::make_unique<control::Planner>();
  std::unique_ptr<control::Plan> plan = std::make_unique<control::Plan>();
  control::PlannerInput input;
};

}  // namespace stilt::benchmark
