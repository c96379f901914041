#include "firmware/control_loop/gait_fallback.h"

namespace stilt::control_loop {

void GaitFallback::configure(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                             const gait::GaitLibrary* library) noexcept {
  robot_ = &robot;
  library_ = library;
  if (library_ != nullptr) tracker_.configure(robot, parameters.gait_tracker, parameters.robot, *library_);
  forget();
}

void GaitFallback::forget() noexcept {
  in_step_ = landed_ = false;
  planned_ = {true, true};
}

model::ContactMode GaitFallback::contact() const noexcept {
  return {tracker_.stance() == model::kLeft, tracker_.stance() == model::kRight};
}

void GaitFallback::tick(const control::SensorReading& reading, const model::ContactMode* planned,
                        const model::StateVector& estimate, double speed_m_s) noexcept {
  landed_ = false;
  if (library_ == nullptr) return;
  if (planned != nullptr) look_for_touch_down(reading, *planned, estimate, speed_m_s);
  if (in_step_) command_ = tracker_.tick(reading, speed_m_s);
}

/// A gait begins with one foot on the ground that was not there before; while both are, it waits.
void GaitFallback::look_for_touch_down(const control::SensorReading& reading, model::ContactMode planned,
                                       const model::StateVector& estimate, double speed_m_s) noexcept {
  landed_ = planned.count() == 1 && !(planned == planned_);
  planned_ = planned;
  if (planned.count() != 1) in_step_ = false;
  if (!landed_) return;
  const int stance = planned.left ? model::kLeft : model::kRight;
  model::KinematicsTerms<double> feet;
  robot_->kinematics(estimate.data(), feet);
  tracker_.start(reading.time_s, stance, feet.foot_position[2 * stance], speed_m_s);
  in_step_ = true;
}

}  // namespace stilt::control_loop
