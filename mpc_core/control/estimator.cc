#include "mpc_core/control/estimator.h"

#include <algorithm>

namespace stilt::control {
namespace {

using model::kFeet;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kPositions;

/// State with the base at the origin at rest: the feet's positions and velocities are then relative to the base.
model::StateVector state_at_origin(const SensorReading& reading) noexcept {
  model::StateVector state = model::StateVector::Zero();
  state[kFirstAngle] = reading.base_pitch_rad;
  state[kPositions + kFirstAngle] = reading.base_pitch_rate_rad_s;
  state.segment<model::kJoints>(kFirstJoint) = reading.joint_position_rad;
  state.segment<model::kJoints>(kPositions + kFirstJoint) = reading.joint_velocity_rad_s;
  return state;
}

}  // namespace

void Estimator::configure(const model::RobotModel& robot, const EstimatorParameters& parameters) noexcept {
  robot_ = &robot;
  parameters_ = parameters;
}

void Estimator::reset(const SensorReading& reading, double base_x_m) noexcept {
  const model::StateVector state = state_at_origin(reading);
  model::KinematicsTerms<double> feet;
  robot_->scalar.kinematics(state.data(), feet);
  last_time_s_ = reading.time_s;
  base_x_m_ = base_x_m;
  for (int foot = 0; foot < kFeet; ++foot) {
    in_contact_[foot] = true;
    weight_[foot] = 1.0;
    anchor_x_m_[foot] = base_x_m + feet.foot_position[2 * foot];
  }
}

model::StateVector Estimator::update(const SensorReading& reading, model::ContactMode contact) noexcept {
  model::StateVector state = state_at_origin(reading);
  model::KinematicsTerms<double> feet;
  robot_->scalar.kinematics(state.data(), feet);
  const double elapsed_s = std::clamp(reading.time_s - last_time_s_, 0.0, parameters_.blend_s);
  last_time_s_ = reading.time_s;

  double total = 0.0;
  double x_m = 0.0;
  double z_m = 0.0;
  double vx_m_s = 0.0;
  double vz_m_s = 0.0;
  for (int foot = 0; foot < kFeet; ++foot) {
    if (contact[foot] && !in_contact_[foot]) anchor_x_m_[foot] = base_x_m_ + feet.foot_position[2 * foot];
    in_contact_[foot] = contact[foot];
    const double change = elapsed_s / parameters_.blend_s;
    weight_[foot] = std::clamp(weight_[foot] + (contact[foot] ? change : -change), 0.0, 1.0);
    total += weight_[foot];
    x_m += weight_[foot] * (anchor_x_m_[foot] - feet.foot_position[2 * foot]);
    z_m -= weight_[foot] * feet.foot_position[2 * foot + 1];
    vx_m_s -= weight_[foot] * feet.foot_velocity[2 * foot];
    vz_m_s -= weight_[foot] * feet.foot_velocity[2 * foot + 1];
  }
  if (total > 0.0) {
    base_x_m_ = x_m / total;
    state[1] = z_m / total;
    state[kPositions] = vx_m_s / total;
    state[kPositions + 1] = vz_m_s / total;
  }
  state[0] = base_x_m_;
  return state;
}

}  // namespace stilt::control
