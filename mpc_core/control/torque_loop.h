#pragma once

#include "mpc_core/control/drive_model.h"
#include "mpc_core/control/estimator.h"
#include "mpc_core/control/plan.h"

namespace stilt::control {

/// The plan at one time: positions on the cubic through the nodes' positions and velocities, velocities
/// linear, inputs linear within a contact phase and held at its end (inputs held over every interval lag
/// behind the motion: touch-down comes early and torques peak).
struct PlanPoint {
  model::StateVector state;
  model::InputVector input;
  const FeedbackGain* gain;
  model::ContactMode mode;
};

/// Plan at a time, clamped to its ends. The plan has at least two nodes.
[[nodiscard]] PlanPoint interpolate(const Plan& plan, double time_s) noexcept;

enum class TorqueStatus {
  tracking,
  damping_no_plan,     ///< no plan yet
  damping_stale_plan,  ///< the plan has ended
  damping_not_finite,  ///< a sensor or the plan gave NaN or infinity
};

struct TorqueCommand {
  TorqueStatus status = TorqueStatus::damping_no_plan;
  /// NaN when the sensors are not finite, so that no plan starts from it.
  model::StateVector estimated_state = model::StateVector::Zero();
  model::JointVector torque_Nm = model::JointVector::Zero();
  bool saturated = false;
};

/// The 1 kHz path: sensors and plan in, joint torques out.
///
///   tau = tau_ff(x_plan, u) + kp (q_plan - q) + kd (v_plan - v) + friction, limited to the joint's torque
///   u = u_plan (+ K (x - x_plan) with use_feedback_gains)
///
/// tau_ff is the torque equation of the whole-body dynamics. The limit is the drive's at the joint's
/// velocity. Without a usable plan the joints are damped, tau = -kd v (a joint whose velocity is not finite
/// gets no torque). Never fails, never gives NaN torque. Fixed memory, real-time safe.
class TorqueLoop {
 public:
  void configure(const model::RobotModel& robot, const ControllerParameters& parameters) noexcept;

  /// Other gains, from the next tick on. Real-time.
  void tune(const TorqueLawParameters& law) noexcept { law_ = law; }

  /// Starts with both feet on the ground and the base at x = base_x_m.
  void reset(const SensorReading& reading, double base_x_m) noexcept { estimator_.reset(reading, base_x_m); }

  /// One tick with the estimator's state.
  [[nodiscard]] TorqueCommand tick(const SensorReading& reading, const Plan& plan) noexcept;

  /// One tick with a state known otherwise (simulation).
  [[nodiscard]] TorqueCommand tick_with_state(const SensorReading& reading, const model::StateVector& state,
                                              const Plan& plan) noexcept;

 private:
  [[nodiscard]] model::JointVector track(const SensorReading& reading, const model::StateVector& state,
                                         const PlanPoint& point) const noexcept;
  [[nodiscard]] TorqueCommand damp_not_finite(const SensorReading& reading) const noexcept;
  void limit(const SensorReading& reading, TorqueCommand& command) const noexcept;

  const model::RobotModel* robot_ = nullptr;
  TorqueLawParameters law_;
  DriveModel drive_{};
  Estimator estimator_;
};

}  // namespace stilt::control
