#include "mpc_core/control/planner_settings.h"

#include <algorithm>
#include <cmath>

#include "mpc_core/control/drive_model.h"
#include "mpc_core/gait/reference.h"
#include "mpc_core/ocp/horizon.h"

namespace stilt::control {
namespace {

using model::kJoints;

ocp::JointLimits limits_of(const model::RobotConstants& robot, const RobotParameters& parameters,
                           const DriveModel& drive) noexcept {
  ocp::JointLimits limits{};
  for (int j = 0; j < kJoints; ++j) {
    limits.position_min_rad[j] = robot.position_min_rad[j];
    limits.position_max_rad[j] = robot.position_max_rad[j];
    limits.velocity_rad_s[j] = parameters.velocity_limit_scale * robot.velocity_limit_rad_s[j];
    limits.torque_Nm[j] = drive.torque_limit_Nm[j];
    limits.torque_speed_slope_Nms_rad[j] = drive.torque_speed_slope_Nms_rad[j];
  }
  return limits;
}

bool fits(const ControllerParameters& p) noexcept {
  return ocp::most_intervals(p.discretisation) <= ocp::kMaxHorizonIntervals &&
         ocp::most_switches(p.discretisation, p.gait) <= ocp::kMaxSwitches;
}

}  // namespace

ConfigureStatus prepare_settings(const model::RobotModel& robot, const ControllerParameters& parameters,
                                 sqp::TerminalCostWorkspace& work, PlannerSettings& settings) noexcept {
  if (!fits(parameters)) return ConfigureStatus::horizon_over_capacity;
  settings.parameters = parameters;
  ocp::ProblemData& data = settings.data;
  data.robot = &robot;
  data.cost = parameters.cost;
  data.inequality = parameters.inequality;
  data.equality = parameters.equality;
  data.discretisation = parameters.discretisation;
  const DriveModel drive = drive_model(robot.constants, parameters.robot);
  data.limits = limits_of(robot.constants, parameters.robot, drive);
  std::ranges::copy(drive.joint_parameters, data.joint_parameters);
  ocp::set_weights(data);
  const model::StateVector upright = gait::standing_state(robot.constants, parameters.reference.base_height_m,
                                                          parameters.reference.base_pitch_rad, 0.0, true);
  return sqp::set_terminal_cost(data, upright, work) ? ConfigureStatus::ok
                                                     : ConfigureStatus::terminal_cost_failed;
}

}  // namespace stilt::control
