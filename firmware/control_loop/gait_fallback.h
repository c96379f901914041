#pragma once

#include "mpc_core/control/gait_tracker.h"

namespace stilt::control_loop {

/// The fallback level below planning: a gait of the library tracked by the joints (GaitTracker). While plans
/// come it follows the walk without commanding anything: it starts anew at each touch-down of the plan, so
/// that it is in step when the plans end. Fixed memory, real-time safe.
class GaitFallback {
 public:
  /// @param library  at least one gait, outlives this object; nullptr: there is no such level
  void configure(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                 const gait::GaitLibrary* library) noexcept;

  /// There is such a level.
  [[nodiscard]] bool available() const noexcept { return library_ != nullptr; }

  /// Not in step with anything: the robot does not step, or stands on other ground than before.
  void forget() noexcept;

  /// The robot leaves a plan for the gait, before the tick in which it does.
  void take_over() noexcept { tracker_.take_over(); }

  /// One tick of a robot that steps.
  /// @param planned    feet on the ground by the plan to follow now, nullptr without one
  /// @param estimate   state to take the place of the stance foot from, see model/types.h
  /// @param speed_m_s  commanded; 0: in place
  void tick(const control::SensorReading& reading, const model::ContactMode* planned,
            const model::StateVector& estimate, double speed_m_s) noexcept;

  /// The plan put a foot down in this tick. The gait begins there: a robot that leaves the plan in the middle
  /// of a step is far from it.
  [[nodiscard]] bool landed() const noexcept { return landed_; }

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
  void look_for_touch_down(const control::SensorReading& reading, model::ContactMode planned,
                           const model::StateVector& estimate, double speed_m_s) noexcept;

  const model::RobotModel* robot_ = nullptr;
  const gait::GaitLibrary* library_ = nullptr;
  control::GaitTracker tracker_;
  control::GaitTracker::Command command_;
  model::ContactMode planned_{true, true};  ///< of the plan in the tick before
  bool in_step_ = false;
  bool landed_ = false;
};

}  // namespace stilt::control_loop
