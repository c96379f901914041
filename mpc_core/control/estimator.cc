#include "mpc_core/control/estimator.h"

#include <algorithm>

#include "mpc_core/model/debug_assert.h"

namespace stilt::control {
namespace {

using model::kFeet;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kPositions;

constexpr double kLifted_m = 0.02;   ///< of a swing foot above the stance foot: on its way
constexpr double kLanded_m = 0.003;  ///< of a swing foot below the stance foot: beyond noise and soft ground

/// State with the base at rest at the origin. The positions and velocities of the feet are then relative to
/// the base.
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
  STILT_ASSERT(robot_ != nullptr && std::isfinite(base_x_m));
  const model::StateVector state = state_at_origin(reading);
  model::KinematicsTerms<double> feet;
  robot_->kinematics(state.data(), feet);
  last_time_s_ = reading.time_s;
  base_x_m_ = base_x_m;
  velocity_.setZero();
  scheduled_ = {true, true};
  swing_foot_lifted_ = landed_early_ = false;
  for (int foot = 0; foot < kFeet; ++foot) {
    in_contact_[foot] = true;
    weight_[foot] = 1.0;
    anchor_x_m_[foot] = base_x_m + feet.foot_position[2 * foot];
  }
}

double Estimator::base_x_m(const model::KinematicsTerms<double>& feet) const noexcept {
  double total = 0.0;
  double x_m = 0.0;
  for (int foot = 0; foot < kFeet; ++foot) {
    total += weight_[foot];
    x_m += weight_[foot] * (anchor_x_m_[foot] - feet.foot_position[2 * foot]);
  }
  return total > 0.0 ? x_m / total : base_x_m_;
}

void Estimator::follow_contacts(const model::KinematicsTerms<double>& feet, double elapsed_s,
                                model::ContactMode contact) noexcept {
  const double seen_x_m = base_x_m(feet);  // base from the feet trusted so far
  const double change =
      parameters_.blend_s > 0.0 ? std::clamp(elapsed_s / parameters_.blend_s, 0.0, 1.0) : 1.0;
  for (int foot = 0; foot < kFeet; ++foot) {
    if (contact[foot] && !in_contact_[foot]) anchor_x_m_[foot] = seen_x_m + feet.foot_position[2 * foot];
    in_contact_[foot] = contact[foot];
    weight_[foot] = std::clamp(weight_[foot] + (contact[foot] ? change : -change), 0.0, 1.0);
  }
  if (!landed_early_ || contact == scheduled_) return;
  const int landed = scheduled_[model::kLeft] ? model::kRight : model::kLeft;
  if (!contact[landed]) return;
  weight_[landed] = 1.0;
  weight_[1 - landed] = 0.0;
}

std::array<double, kFeet> Estimator::carrying(const model::KinematicsTerms<double>& feet,
                                              model::ContactMode contact) noexcept {
  if (!(contact == scheduled_)) swing_foot_lifted_ = landed_early_ = false;
  scheduled_ = contact;
  if (contact[model::kLeft] == contact[model::kRight]) return {weight_[0], weight_[1]};
  const int swing = contact[model::kLeft] ? model::kRight : model::kLeft;
  const int stance = 1 - swing;
  const double height_m = feet.foot_position[2 * swing + 1] - feet.foot_position[2 * stance + 1];
  swing_foot_lifted_ = swing_foot_lifted_ || height_m > kLifted_m;
  landed_early_ = landed_early_ || (swing_foot_lifted_ && height_m < -kLanded_m);
  if (!landed_early_) return {weight_[0], weight_[1]};
  return {swing == model::kLeft ? 1.0 : 0.0, swing == model::kRight ? 1.0 : 0.0};
}

void Estimator::filter_velocity(double elapsed_s, const BaseVelocity* planned_change,
                                model::StateVector& state) noexcept {
  auto measured = state.segment<2>(kPositions);
  if (planned_change == nullptr || !(parameters_.velocity_filter_s > 0.0) || !velocity_.allFinite()) {
    velocity_ = measured;
    return;
  }
  const double share = 1.0 - std::exp(-elapsed_s / parameters_.velocity_filter_s);
  velocity_ += *planned_change;
  const BaseVelocity correction = share * (measured - velocity_);
  const double most_m_s = parameters_.velocity_correction_max_m_s2 * elapsed_s;
  velocity_ += correction.cwiseMin(most_m_s).cwiseMax(-most_m_s);
  measured = velocity_;
}

model::StateVector Estimator::update(const SensorReading& reading, model::ContactMode contact,
                                     const BaseVelocity* planned_change) noexcept {
  model::StateVector state = state_at_origin(reading);
  model::KinematicsTerms<double> feet;
  robot_->kinematics(state.data(), feet);
  const double elapsed_s = reading.time_s - last_time_s_;
  follow_contacts(feet, elapsed_s, contact);
  last_time_s_ = reading.time_s;
  base_x_m_ = base_x_m(feet);

  const std::array<double, kFeet> carrying_weight = carrying(feet, contact);
  double total = 0.0, carrying_total = 0.0;
  double z_m = 0.0;
  double vx_m_s = 0.0;
  double vz_m_s = 0.0;
  for (int foot = 0; foot < kFeet; ++foot) {
    const double carries = carrying_weight[static_cast<std::size_t>(foot)];
    total += weight_[foot];
    carrying_total += carries;
    z_m -= carries * feet.foot_position[2 * foot + 1];
    vx_m_s -= weight_[foot] * feet.foot_velocity[2 * foot];
    vz_m_s -= carries * feet.foot_velocity[2 * foot + 1];
  }
  if (total > 0.0) state[kPositions] = vx_m_s / total;
  if (carrying_total > 0.0) {
    state[1] = z_m / carrying_total;
    state[kPositions + 1] = vz_m_s / carrying_total;
  }
  state[0] = base_x_m_;
  filter_velocity(elapsed_s, planned_change, state);
  return state;
}

}  // namespace stilt::control
