#include "firmware/controller/gait_fallback.h"

#include "mpc_core/control/torque_loop.h"

namespace stilt::controller {

void GaitFallback::configure(const model::RobotModel& robot, const control::RobotParameters& assumed,
                             const gait::GaitLibrary* library) noexcept {
  robot_ = &robot;
  library_ = library;
  if (library_ != nullptr) tracker_.configure(robot, {}, assumed, *library_);
  forget();
}

void GaitFallback::forget() noexcept {
  in_step_ = false;
  planned_ = {true, true};
}

model::ContactMode GaitFallback::contact() const noexcept {
  return {tracker_.stance() == model::kLeft, tracker_.stance() == model::kRight};
}

void GaitFallback::tick(const control::SensorReading& reading, const control::Plan* plan,
                        const model::StateVector& estimate, double speed_m_s) noexcept {
  if (library_ == nullptr) return;
  if (plan != nullptr) look_for_touch_down(reading, *plan, estimate, speed_m_s);
  if (in_step_) command_ = tracker_.tick(reading, speed_m_s);
}

/// A gait begins with one foot on the ground that was not there before; while both are, it waits.
void GaitFallback::look_for_touch_down(const control::SensorReading& reading, const control::Plan& plan,
                                       const model::StateVector& estimate, double speed_m_s) noexcept {
  const model::ContactMode now = control::interpolate(plan, reading.time_s).mode;
  const bool lands = now.count() == 1 && !(now == planned_);
  planned_ = now;
  if (now.count() != 1) in_step_ = false;
  if (!lands) return;
  const int stance = now.left ? model::kLeft : model::kRight;
  model::KinematicsTerms<double> feet;
  robot_->scalar.kinematics(estimate.data(), feet);
  tracker_.start(reading.time_s, stance, feet.foot_position[2 * stance], speed_m_s);
  in_step_ = true;
}

}  // namespace stilt::controller
