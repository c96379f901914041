#pragma once

#include "mpc_core/control/drive_model.h"
#include "mpc_core/control/estimator.h"
#include "mpc_core/control/plan.h"

namespace stilt::control {

struct TorqueCommand {
  model::JointVector torque_Nm = model::JointVector::Zero();
  bool finite = false;     ///< otherwise the joints are damped
  bool saturated = false;  ///< a joint is at the limit of its drive
};

/// Whether a plan's own gains correct its inputs.
enum class Feedback {
  as_configured,  ///< TorqueLawParameters::use_feedback_gains
  plan_gains,     ///< always
};

/// Joint torques that follow a plan at one instant:
///
///   tau = tau_ff(x_plan, u) + kp (q_plan - q) + kd (v_plan - v) + friction
///   u = u_plan (+ K (x - x_plan) with feedback)
///
/// limited to the drive's torque at the joint's velocity. tau_ff is the torque equation of the whole-body
/// dynamics. When sensors, state or plan are not finite the joints are damped, tau = -kd v; a joint whose
/// velocity is not finite gets no torque. Never gives NaN. Fixed memory, real-time safe.
class TorqueLaw {
 public:
  void configure(const model::RobotModel& robot, const ControllerParameters& parameters) noexcept;

  /// Other gains, from the next call on. Real-time safe.
  void tune(const TorqueLawParameters& law) noexcept { law_ = law; }

  /// @param state  estimated, for the feedback
  /// @param point  of the plan, at the time of the reading
  [[nodiscard]] TorqueCommand follow(const SensorReading& reading, const model::StateVector& state,
                                     const PlanPoint& point, Feedback feedback) const noexcept;

 private:
  [[nodiscard]] model::JointVector track(const SensorReading& reading, const model::StateVector& planned,
                                         const model::InputVector& input) const noexcept;

  const model::RobotModel* robot_ = nullptr;
  TorqueLawParameters law_;
  DriveModel drive_{};
};

}  // namespace stilt::control
