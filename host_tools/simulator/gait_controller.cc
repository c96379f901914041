#include "host_tools/simulator/gait_controller.h"

#include <utility>

namespace stilt::simulator {

GaitController::GaitController(const model::RobotModel& robot,
                               const control::ControllerParameters& parameters,
                               std::unique_ptr<MpcController> starter,
                               std::shared_ptr<const gait::GaitLibrary> library, double hand_over_s)
    : robot_(robot), starter_(std::move(starter)), library_(std::move(library)), hand_over_s_(hand_over_s) {
  tracker_.configure(robot, {}, parameters.robot, *library_);
}

void GaitController::reset(const model::StateVector& state, double time_s) {
  starter_->reset(state, time_s);
  tracking_ = false;
  mode_ = {true, true};
}

TickOutput GaitController::tick(const control::SensorReading& reading, const model::StateVector* true_state) {
  if (!tracking_) {
    const TickOutput output = starter_->tick(reading, true_state);
    hand_over(reading, true_state != nullptr ? *true_state : output.estimated_state);
    if (!tracking_) return output;
  }
  const control::GaitTracker::Command command = tracker_.tick(reading, speed_m_s());
  return {command.estimated_state, command.torque_Nm};
}

void GaitController::hand_over(const control::SensorReading& reading, const model::StateVector& state) {
  const control::Plan& plan = starter_->plan_in_use();
  if (plan.nodes < 2) return;
  const model::ContactMode before = mode_;
  mode_ = control::interpolate(plan, reading.time_s).mode;
  const bool lands = before.count() == 1 && mode_.count() == 1 && !(before == mode_);
  if (!lands || reading.time_s < hand_over_s_ || command_.kind == gait::GaitKind::stand) return;
  const int stance = mode_.left ? model::kLeft : model::kRight;
  model::KinematicsTerms<double> feet;
  robot_.scalar.kinematics(state.data(), feet);
  tracker_.start(reading.time_s, stance, feet.foot_position[2 * stance], speed_m_s());
  tracking_ = true;
}

std::optional<solver::SolveReport> GaitController::plan(double time_s, const gait::GaitCommand& command) {
  command_ = command;
  if (tracking_) return std::nullopt;
  return starter_->plan(time_s, command);
}

void GaitController::adopt_plan() {
  if (!tracking_) starter_->adopt_plan();
}

}  // namespace stilt::simulator
