#include "host_tools/simulator/mpc_controller.h"

namespace stilt::simulator {

control::ConfigureStatus MpcController::configure(const model::RobotModel& robot,
                                                  const model::RobotModel& planning_model,
                                                  const control::ControllerParameters& parameters) {
  torque_loop_.configure(robot, parameters);
  return planner_.configure(planning_model, parameters);
}

void MpcController::reset(const model::StateVector& state, double time_s) {
  control::SensorReading reading;
  reading.time_s = time_s;
  reading.joint_position_rad = state.segment<model::kJoints>(model::kFirstJoint);
  reading.joint_velocity_rad_s = state.tail<model::kJoints>();
  reading.base_pitch_rad = state[model::kFirstAngle];
  reading.base_pitch_rate_rad_s = state[model::kPositions + model::kFirstAngle];
  torque_loop_.reset(reading, state[0]);
  planner_.reset(time_s);
  for (control::Plan& plan : plans_) plan.nodes = 0;
  in_use_ = newest_ = 0;
  state_ = state;
}

TickOutput MpcController::tick(const control::SensorReading& reading, const model::StateVector* true_state) {
  const control::Plan& plan = plans_[in_use_];
  const control::TorqueCommand command = true_state == nullptr
                                             ? torque_loop_.tick(reading, plan)
                                             : torque_loop_.tick_with_state(reading, *true_state, plan);
  state_ = command.estimated_state;
  return {command.estimated_state, command.torque_Nm};
}

std::optional<solver::SolveReport> MpcController::plan(double time_s, const gait::GaitCommand& command) {
  const std::size_t other = 1 - in_use_;
  const solver::SolveReport report = planner_.plan({time_s, state_, command}, plans_[other]);
  newest_ = report.usable() ? other : in_use_;
  return report;
}

void MpcController::adopt_plan() { in_use_ = newest_; }

}  // namespace stilt::simulator
