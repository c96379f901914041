#pragma once

#include <limits>

#include "mpc_core/control/drive_model.h"
#include "mpc_core/control/estimator.h"
#include "mpc_core/gait/command.h"
#include "mpc_core/gait/gait_library.h"

namespace stilt::control {

/// Tracks a gait with the joints, without planning:
///
///   tau = tau_gait(s) + kp (y(s) + e - q) + kd (dy/ds ds/dt + de/dt - v), limited to the joint's torque
///
/// y are the outputs of the gait and s its phase. The phase is the position of the hip ahead of the stance
/// foot, or the time since touch-down. e leads from another motion to the gait. At take_over() it is q - y
/// and its rate v - dy/dt, and take_over_s later both are 0, with a cubic polynomial between. Touch-down is
/// detected by kinematics over the stance foot on level ground: the swing foot comes down in the second half
/// of the step. The legs then swap, and the library gives the gait for the commanded speed. Needs only the
/// joint and pitch sensors. Fixed memory, real-time safe.
class GaitTracker {
 public:
  /// The library must hold at least one gait and outlive this object.
  void configure(const model::RobotModel& robot, const GaitTrackerParameters& parameters,
                 const RobotParameters& assumed, const gait::GaitLibrary& library) noexcept;

  /// Starts just after a touch-down of the foot `stance`.
  void start(double time_s, int stance, double speed_m_s) noexcept;

  /// From the next tick on the robot follows this gait, and has followed something else before.
  void take_over() noexcept { lead_starts_ = true; }

  struct Command {
    model::JointVector torque_Nm = model::JointVector::Zero();
    /// Joint angles y + e; NaN when a reading is not finite.
    model::JointVector position_rad = model::JointVector::Zero();
    /// Joint velocities dy/dt + de/dt. dy/dt is 0 while the phase saturates at an end of the step, and when a
    /// reading is not finite.
    model::JointVector velocity_rad_s = model::JointVector::Zero();
    bool finite = false;  ///< false: the joints are damped
  };
  [[nodiscard]] Command tick(const SensorReading& reading, double speed_m_s) noexcept;

  [[nodiscard]] int stance() const noexcept { return stance_; }
  [[nodiscard]] gait::TrackedStep step() const noexcept {
    return {stance_, touch_down_s_, gait_.step_time_s};
  }

 private:
  /// Positions and velocities with the stance foot at the origin.
  struct Sensed {
    model::StateVector state;  ///< as in model/types.h
    double swing_foot_z_m;
  };
  [[nodiscard]] Sensed sense(const SensorReading& reading) const noexcept;
  [[nodiscard]] double phase(const Sensed& sensed, double time_s) const noexcept;
  /// Share of the step time at which the gait's hip is at the measured position. A gait with a phase by time
  /// returns that phase.
  [[nodiscard]] double share_of_step(const Sensed& sensed, double s) const noexcept;
  void place_foot(const Sensed& sensed, double time_s) noexcept;
  /// Of the joints, left leg first.
  struct JointMotion {
    model::JointVector angle_rad, velocity_rad_s;
  };
  /// The outputs at the phase s, with the foot placement.
  [[nodiscard]] JointMotion outputs(const Sensed& sensed, double s) const noexcept;
  /// e of the class comment, and its rate.
  [[nodiscard]] JointMotion lead(double time_s) const noexcept;
  /// Computes torque, before the limit, and motion of the joints.
  void track(const Sensed& sensed, double time_s, Command& command) noexcept;

  const model::RobotModel* robot_ = nullptr;
  const gait::GaitLibrary* library_ = nullptr;
  GaitTrackerParameters parameters_;
  DriveModel drive_{};
  gait::HzdGait gait_;
  int stance_ = model::kLeft;
  double touch_down_s_ = 0.0;
  double shift_rad_ = 0.0;
  bool placed_ = false;
  bool lead_starts_ = false;
  double lead_start_s_ = -std::numeric_limits<double>::infinity();
  JointMotion lead_{};  ///< e at take_over()
};

}  // namespace stilt::control
