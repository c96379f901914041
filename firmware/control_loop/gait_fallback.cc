#include "firmware/control_loop/gait_fallback.h"

#include <algorithm>

namespace stilt::control_loop {

void GaitFallback::configure(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                             const supervisor::SupervisorParameters& supervision,
                             const gait::GaitLibrary* library) noexcept {
  library_ = library;
  supervision_ = supervision;
  if (library_ != nullptr) tracker_.configure(robot, parameters.gait_tracker, parameters.robot, *library_);
  forget(0.0);
}

void GaitFallback::forget(double time_s) noexcept {
  in_step_ = landed_ = led_ = selected_ = awaits_touch_down_ = false;
  planned_ = {true, true};
  stepping_since_s_ = time_s;
}

model::ContactMode GaitFallback::contact() const noexcept {
  return {tracker_.stance() == model::kLeft, tracker_.stance() == model::kRight};
}

void GaitFallback::tick(const control::SensorReading& reading, const Beside& plan,
                        double speed_m_s) noexcept {
  landed_ = false;
  if (library_ == nullptr) return;
  const bool led = plan.planned != nullptr && !selected_;
  if (led_ && !led && !selected_) tracker_.take_over();
  led_ = led;
  if (led) look_for_touch_down(reading.time_s, *plan.planned, speed_m_s);
  if (in_step_) command_ = tracker_.tick(reading, speed_m_s);
  const bool may_select =
      supervision_.select_gait && reading.time_s - stepping_since_s_ >= supervision_.select_gait_after_s;
  selected_ = selected_ || (may_select && landed_);
  const bool fresh = plan.plan_age_s < supervision_.stale_plan_s;
  awaits_touch_down_ = fresh || (awaits_touch_down_ && !landed_);
}

bool GaitFallback::awaits_touch_down(const control::Plan& plan, double time_s,
                                     model::ContactMode now) const noexcept {
  const bool lands_now = now.count() == 1 && !(now == planned_);  // the plan may have no later touch-down
  const auto lands = [&](const control::PlanNode& node) {
    return node.time_s > time_s && node.mode.count() == 1 && !(node.mode == now);
  };
  return awaits_touch_down_ &&
         (lands_now || std::any_of(plan.node.begin(), plan.node.begin() + plan.nodes, lands));
}

/// A gait begins with one foot on the ground that was not there before; while both are, it waits.
void GaitFallback::look_for_touch_down(double time_s, model::ContactMode planned, double speed_m_s) noexcept {
  landed_ = planned.count() == 1 && !(planned == planned_);
  planned_ = planned;
  if (planned.count() != 1) in_step_ = false;
  if (!landed_) return;
  tracker_.start(time_s, planned.left ? model::kLeft : model::kRight, speed_m_s);
  in_step_ = true;
}

}  // namespace stilt::control_loop
