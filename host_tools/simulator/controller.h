#pragma once

#include <cstddef>
#include <optional>

#include "mpc_core/control/plan.h"
#include "mpc_core/control/torque_loop.h"
#include "mpc_core/gait/command.h"
#include "mpc_core/model/types.h"

namespace stilt::simulator {

/// What one tick of a torque loop gives.
struct TickOutput {
  model::StateVector estimated_state = model::StateVector::Zero();
  model::JointVector torque_Nm = model::JointVector::Zero();
};

/// A controller as the simulation sees it: a torque loop, and a planner beside it whose result comes into use
/// when the simulation says so.
class Controller {
 public:
  virtual ~Controller() = default;

  /// Starts at rest in the given state, in stance on both feet.
  virtual void reset(const model::StateVector& state, double time_s) = 0;

  /// One tick of the torque loop. `true_state` replaces the estimate when it is not null.
  virtual TickOutput tick(const control::SensorReading& reading, const model::StateVector* true_state) = 0;

  /// One cycle of the planner, from the state of the newest tick or of reset(). The torque loop keeps its
  /// older plan. Nothing when the controller does not plan.
  virtual std::optional<solver::SolveReport> plan(double time_s, const gait::GaitCommand& command) = 0;

  /// Hands the result of the newest plan() to the torque loop, if it is usable.
  virtual void adopt_plan() = 0;

  /// The newest usable result of plan(), and the plan that the torque loop follows; without nodes when there
  /// is none.
  [[nodiscard]] virtual const control::Plan& newest_plan() const = 0;
  [[nodiscard]] virtual const control::Plan& plan_in_use() const = 0;

  /// Size of the controller's object.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
};

}  // namespace stilt::simulator
