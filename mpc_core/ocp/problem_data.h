#pragma once

#include "mpc_core/lq/lq_problem.h"
#include "mpc_core/model/robot.h"
#include "mpc_core/ocp/parameters.h"

namespace stilt::ocp {

/// Active weights and limits, and values derived from them.
struct ProblemData {
  const model::RobotModel* robot = nullptr;
  CostParameters cost;
  InequalityParameters inequality;
  EqualityParameters equality;
  DiscretisationParameters discretisation;
  JointLimits limits{};
  double joint_parameters[2 * model::kJoints] = {};
  MinimumNormalForce minimum_normal_force_N;
  double state_weight[model::kStates] = {};
  double input_weight[model::kInputs] = {};
  double terminal_weight[model::kStates][lq::kRows] = {};  ///< rho S, by columns
};

/// Sets the diagonal weights from the named ones, and the least normal force from the robot's weight.
void set_weights(ProblemData& data) noexcept;

}  // namespace stilt::ocp
