#pragma once

#include "mpc_core/control/drive_model.h"
#include "mpc_core/control/estimator.h"
#include "mpc_core/control/plan.h"

namespace stilt::control {

/// Joint torques of one tick, and how they were computed.
struct TorqueCommand {
  model::JointVector torque_Nm = model::JointVector::Zero();
  bool finite = false;  ///< false: the joints are damped
};

/// Joint torques that follow a plan at one instant:
///
///   tau = tau_ff(x_plan, u) + kp (q_plan - q) + kd (v_plan - v) + friction
///   u = u_plan + w K (x - x_plan), contact forces f then bounded:
///   stance foot fz >= least normal force, |fx| <= mu fz; swing foot f = 0
///
/// w grows with the age of the plan (docs/decisions/0038-feedback-by-plan-age.md). tau_ff is the torque
/// equation of the whole-body dynamics. Each torque is limited to the drive's torque at the joint's velocity.
/// When readings, state or plan are not finite, the joints are damped: tau = -kd v. A joint whose velocity is
/// not finite gets zero torque. The torque is never NaN. Fixed memory, real-time safe.
class TorqueLaw {
 public:
  void configure(const model::RobotModel& robot, const ControllerParameters& parameters) noexcept;

  /// Replaces the parameters from the next call on. After configure(). Real-time safe.
  void tune(const TorqueLawParameters& law) noexcept;

  /// @param state  estimated state, for the feedback
  /// @param point  the plan at the time of the reading
  [[nodiscard]] TorqueCommand follow(const SensorReading& reading, const model::StateVector& state,
                                     const PlanPoint& point) const noexcept;

 private:
  /// Forces of feet in stance moved into the friction cone above the least normal force, those of feet in the
  /// air removed.
  void bound_contact_forces(model::ContactMode mode, model::InputVector& input) const noexcept;
  [[nodiscard]] model::JointVector track(const SensorReading& reading, const model::StateVector& planned,
                                         const model::InputVector& input) const noexcept;

  const model::RobotModel* robot_ = nullptr;
  TorqueLawParameters law_;
  DriveModel drive_{};
  double friction_coefficient_ = 0.0;
  ocp::MinimumNormalForce minimum_normal_force_N_;
};

}  // namespace stilt::control
