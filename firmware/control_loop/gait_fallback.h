#pragma once

#include "firmware/supervisor/parameters.h"
#include "mpc_core/control/gait_tracker.h"
#include "mpc_core/control/plan.h"

namespace stilt::control_loop {

/// The fallback level below planning: a gait of the library tracked by the joints (GaitTracker). While plans
/// come it follows the walk without commanding anything. It starts anew at each touch-down of the plan, so
/// that it is in step when the plans end. A stale plan is followed to its next touch-down, where the gait
/// takes over (docs/decisions/0041-the-gait-takes-over-at-a-touch-down.md). Fixed memory, real-time safe.
class GaitFallback {
 public:
  /// The plan beside the gait in a tick.
  struct Beside {
    const model::ContactMode* planned = nullptr;  ///< feet on the ground by the plan to follow; nullptr: none
    double plan_age_s = 0.0;                      ///< of the newest plan, to be followed or not
  };

  /// @param supervision  stale_plan_s, select_gait and select_gait_after_s
  /// @param library      at least one gait, outlives this object; nullptr: there is no such level
  void configure(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                 const supervisor::SupervisorParameters& supervision,
                 const gait::GaitLibrary* library) noexcept;

  /// Not in step with anything: the robot does not step, or stands on other ground than before.
  /// @param time_s  now; supervisor.select_gait_after_s counts from here
  void forget(double time_s) noexcept;

  /// One tick of a robot that steps.
  /// @param speed_m_s  commanded; 0: in place
  void tick(const control::SensorReading& reading, const Beside& plan, double speed_m_s) noexcept;

  /// A stale plan is to be followed on, to its next touch-down, where the gait takes over. A robot that
  /// leaves the plan in the middle of a step is far from the gait.
  /// @param now  feet on the ground by the plan at time_s
  [[nodiscard]] bool awaits_touch_down(const control::Plan& plan, double time_s,
                                       model::ContactMode now) const noexcept;

  /// Plans are not followed, by supervisor.select_gait.
  [[nodiscard]] bool selected() const noexcept { return selected_; }

  /// In step since a touch-down, with a command for this tick.
  [[nodiscard]] bool ready() const noexcept { return in_step_ && command_.finite; }
  [[nodiscard]] const model::JointVector& torque_Nm() const noexcept { return command_.torque_Nm; }
  /// Of the joints, by the gait.
  [[nodiscard]] const model::JointVector& position_rad() const noexcept { return command_.position_rad; }
  [[nodiscard]] const model::JointVector& velocity_rad_s() const noexcept { return command_.velocity_rad_s; }
  /// Which foot carries, by the gait; meaningful when ready().
  [[nodiscard]] model::ContactMode contact() const noexcept;
  /// For the schedule of the planner; meaningful when ready().
  [[nodiscard]] gait::TrackedStep step() const noexcept { return tracker_.step(); }

 private:
  void look_for_touch_down(double time_s, model::ContactMode planned, double speed_m_s) noexcept;

  const gait::GaitLibrary* library_ = nullptr;
  supervisor::SupervisorParameters supervision_;
  control::GaitTracker tracker_;
  control::GaitTracker::Command command_;
  model::ContactMode planned_{true, true};  ///< of the plan in the tick before
  bool in_step_ = false;
  bool landed_ = false;  ///< the plan put a foot down in this tick
  bool led_ = false;     ///< by a plan in the tick before
  bool selected_ = false;
  bool awaits_touch_down_ = false;
  double stepping_since_s_ = 0.0;
};

}  // namespace stilt::control_loop
