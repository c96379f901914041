#include "mpc_core/control/gait_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpc_core/model/debug_assert.h"

namespace stilt::control {
namespace {

using model::JointVector;
using model::kAngles;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;

/// Converts joints from left leg first to stance leg first, or back.
JointVector exchange(const JointVector& joints, int stance) noexcept {
  if (stance == model::kLeft) return joints;
  JointVector result;
  result << joints.tail<2>(), joints.head<2>();
  return result;
}

}  // namespace

void GaitTracker::configure(const model::RobotModel& robot, const GaitTrackerParameters& parameters,
                            const RobotParameters& assumed, const gait::GaitLibrary& library) noexcept {
  robot_ = &robot;
  library_ = &library;
  parameters_ = parameters;
  drive_ = drive_model(robot.constants, assumed);
}

void GaitTracker::start(double time_s, int stance, double speed_m_s) noexcept {
  STILT_ASSERT(robot_ != nullptr && (stance == 0 || stance == 1));
  stance_ = stance;
  touch_down_s_ = time_s;
  shift_rad_ = 0.0;
  placed_ = false;
  library_->blend(speed_m_s, gait_);
}

GaitTracker::Sensed GaitTracker::sense(const SensorReading& reading) const noexcept {
  Sensed sensed;
  sensed.state.setZero();
  sensed.state[kFirstAngle] = reading.base_pitch_rad;
  sensed.state.segment<kJoints>(kFirstJoint) = reading.joint_position_rad;
  sensed.state[kPositions + kFirstAngle] = reading.base_pitch_rate_rad_s;
  sensed.state.tail<kJoints>() = reading.joint_velocity_rad_s;
  model::KinematicsTerms<double> feet;
  robot_->kinematics(sensed.state.data(), feet);
  for (int i = 0; i < 2; ++i) {
    sensed.state[i] = -feet.foot_position[2 * stance_ + i];
    sensed.state[kPositions + i] = -feet.foot_velocity[2 * stance_ + i];
  }
  const int swing = 1 - stance_;
  sensed.swing_foot_z_m = sensed.state[1] + feet.foot_position[2 * swing + 1];
  return sensed;
}

double GaitTracker::phase(const Sensed& sensed, double time_s) const noexcept {
  const gait::GaitOutputs& outputs = gait_.outputs;
  const double now = outputs.phase == gait::PhaseKind::time ? time_s - touch_down_s_ : sensed.state[0];
  return std::clamp((now - outputs.phase_start) / (outputs.phase_end - outputs.phase_start), 0.0, 1.0);
}

double GaitTracker::share_of_step(const Sensed& sensed, double s) const noexcept {
  if (gait_.outputs.phase == gait::PhaseKind::time) return s;
  constexpr int kHalvings = 12;
  const double direction = gait_.outputs.phase_end > gait_.outputs.phase_start ? 1.0 : -1.0;
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    const double x_m = gait::evaluate_bezier(gait_.motion.position[0], gait_.motion.degree, middle).value;
    (direction * (x_m - sensed.state[0]) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void GaitTracker::place_foot(const Sensed& sensed, double time_s) noexcept {
  const double elapsed_s = time_s - touch_down_s_;
  if (placed_ || elapsed_s < parameters_.settle_s) return;
  placed_ = true;
  const gait::GaitPoint nominal = gait::motion_at(gait_, elapsed_s / gait_.step_time_s);
  const JointVector joints = exchange(sensed.state.segment<kJoints>(kFirstJoint), stance_);
  const JointVector rates = exchange(sensed.state.tail<kJoints>(), stance_);
  gait::ReducedState error;
  error << sensed.state[kFirstAngle], joints, sensed.state[kPositions + kFirstAngle], rates;
  error.head<kAngles>() -= nominal.position.tail<kAngles>();
  error.tail<kAngles>() -= nominal.velocity.tail<kAngles>();
  double shift_rad = 0.0;
  for (int i = 0; i < gait::kReducedStates; ++i) shift_rad -= gait_.feedback.placement[i] * error[i];
  constexpr double kLargestShift_rad = 0.4;
  shift_rad_ = std::clamp(shift_rad, -kLargestShift_rad, kLargestShift_rad);
}

GaitTracker::JointMotion GaitTracker::outputs(const Sensed& sensed, double s) const noexcept {
  const gait::GaitOutputs& outputs = gait_.outputs;
  const gait::OutputPoint share = gait::placement_share(s);
  const gait::OutputPoint y = gait::outputs_at(outputs, s);
  const bool inside = s > 0.0 && s < 1.0;  // the phase saturates at 0 and 1
  const double scale = 1.0 / (outputs.phase_end - outputs.phase_start);
  const double hip_rate = outputs.phase == gait::PhaseKind::time ? 1.0 : sensed.state[kPositions];
  const double rate = inside ? scale * hip_rate : 0.0;
  const JointVector angle_rad = y.angle_rad + shift_rad_ * share.angle_rad;
  const JointVector velocity_rad_s = rate * (y.slope_rad + shift_rad_ * share.slope_rad);
  return {exchange(angle_rad, stance_), exchange(velocity_rad_s, stance_)};
}

GaitTracker::JointMotion GaitTracker::lead(double time_s) const noexcept {
  const double duration_s = parameters_.take_over_s;
  const double t = time_s - lead_start_s_;
  if (!(t < duration_s)) return {JointVector::Zero(), JointVector::Zero()};
  const double s = t / duration_s;
  const double left = 1.0 - s;
  return {(1.0 + 2.0 * s) * left * left * lead_.angle_rad + t * left * left * lead_.velocity_rad_s,
          -6.0 * s * left / duration_s * lead_.angle_rad + (1.0 - 3.0 * s) * left * lead_.velocity_rad_s};
}

void GaitTracker::track(const Sensed& sensed, double time_s, Command& command) noexcept {
  const double s = phase(sensed, time_s);
  const JointVector joints = sensed.state.segment<kJoints>(kFirstJoint);
  const JointVector rates = sensed.state.tail<kJoints>();
  const JointMotion gait = outputs(sensed, s);
  if (lead_starts_) {
    lead_starts_ = false;
    lead_start_s_ = time_s;
    lead_ = {joints - gait.angle_rad, rates - gait.velocity_rad_s};
  }
  const JointMotion from = lead(time_s);
  command.position_rad = gait.angle_rad + from.angle_rad;
  command.velocity_rad_s = gait.velocity_rad_s + from.velocity_rad_s;
  const gait::GaitPoint nominal = gait::motion_at(gait_, share_of_step(sensed, s));
  command.torque_Nm = exchange(nominal.torque_Nm, stance_) +
                      parameters_.joint_kp_Nm_rad * (command.position_rad - joints) +
                      parameters_.joint_kd_Nms_rad * (command.velocity_rad_s - rates);
}

GaitTracker::Command GaitTracker::tick(const SensorReading& reading, double speed_m_s) noexcept {
  Command command;
  if (is_finite(reading)) {
    Sensed sensed = sense(reading);
    if (sensed.swing_foot_z_m <= 0.0 && phase(sensed, reading.time_s) > 0.5) {
      start(reading.time_s, 1 - stance_, speed_m_s);
      sensed = sense(reading);
    }
    place_foot(sensed, reading.time_s);
    track(sensed, reading.time_s, command);
    command.finite = command.torque_Nm.allFinite();
  }
  for (int j = 0; j < kJoints; ++j) {
    const double velocity = reading.joint_velocity_rad_s[j];
    const double damping_Nm = std::isfinite(velocity) ? -parameters_.joint_kd_Nms_rad * velocity : 0.0;
    const double torque_Nm = command.finite ? command.torque_Nm[j] : damping_Nm;
    command.torque_Nm[j] = drive_.limited_torque_Nm(j, torque_Nm, velocity);
  }
  if (!command.finite) command.position_rad.setConstant(std::numeric_limits<double>::quiet_NaN());
  return command;
}

}  // namespace stilt::control
