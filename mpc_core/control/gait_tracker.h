#pragma once

#include "mpc_core/control/drive_model.h"
#include "mpc_core/control/estimator.h"
#include "mpc_core/gait/gait_library.h"

namespace stilt::control {

/// A gait tracked by the joints without planning:
///
///   tau = tau_gait(s) + kp (y(s) - q) + kd (dy/ds ds/dt - v), limited to the joint's torque
///
/// with the outputs y and the phase s of the gait: the hip's position ahead of the stance foot, or the time
/// since touch-down. The legs swap when the swing foot, by kinematics over the stance foot on level ground,
/// comes down in the second half of the step. The gait for the commanded speed is taken from the library at
/// every touch-down. Needs joint and pitch sensors alone. Fixed memory, real-time safe.
class GaitTracker {
 public:
  /// The library has at least one gait and outlives this object.
  void configure(const model::RobotModel& robot, const GaitTrackerParameters& parameters,
                 const RobotParameters& assumed, const gait::GaitLibrary& library) noexcept;

  /// Starts just after a touch-down of the foot `stance`, which stands at x = foot_x_m in the world.
  void start(double time_s, int stance, double foot_x_m, double speed_m_s) noexcept;

  struct Command {
    /// The base through the stance foot; not a number when a sensor is not finite.
    model::StateVector estimated_state = model::StateVector::Zero();
    model::JointVector torque_Nm = model::JointVector::Zero();
    /// As the gait wants it; 0 while the phase is held at an end of the step, and when a sensor is not
    /// finite.
    model::JointVector velocity_rad_s = model::JointVector::Zero();
    bool finite = false;  ///< otherwise the joints are damped
  };
  [[nodiscard]] Command tick(const SensorReading& reading, double speed_m_s) noexcept;

  [[nodiscard]] int stance() const noexcept { return stance_; }

 private:
  /// Positions and velocities with the stance foot at the origin, and where the feet are.
  struct Sensed {
    model::StateVector state;  ///< as in model/types.h
    double swing_foot_x_m;
    double swing_foot_z_m;
  };
  [[nodiscard]] Sensed sense(const SensorReading& reading) const noexcept;
  [[nodiscard]] double phase(const Sensed& sensed, double time_s) const noexcept;
  /// Share of the step time at which the gait has its hip where it is sensed; for a phase by time that phase.
  [[nodiscard]] double share_of_step(const Sensed& sensed, double s) const noexcept;
  void place_foot(const Sensed& sensed, double time_s) noexcept;
  /// Torque, unlimited, and velocity of the gait.
  void track(const Sensed& sensed, double s, Command& command) const noexcept;

  const model::RobotModel* robot_ = nullptr;
  const gait::GaitLibrary* library_ = nullptr;
  GaitTrackerParameters parameters_;
  DriveModel drive_{};
  gait::HzdGait gait_;
  int stance_ = model::kLeft;
  double touch_down_s_ = 0.0;
  double foot_x_m_ = 0.0;
  double shift_rad_ = 0.0;
  bool placed_ = false;
};

}  // namespace stilt::control
