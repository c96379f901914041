#include "firmware/control_loop/sensor_reading.h"

#include <algorithm>
#include <cmath>

namespace stilt::control_loop {
namespace {

using model::kJoints;

/// The pitch now: the newest one, extrapolated with its rate when the torso sensor is slower than the torque
/// loop.
double pitch_now_rad(const hal::BaseReading& base, std::int64_t now_ns) noexcept {
  const std::int64_t age_ns = std::clamp<std::int64_t>(now_ns - base.time_ns, 0, kLongestExtrapolation_ns);
  const double change_rad = 1e-9 * static_cast<double>(age_ns) * base.pitch_rate_rad_s;
  return std::isfinite(change_rad) ? base.pitch_rad + change_rad : base.pitch_rad;
}

}  // namespace

control::SensorReading sensor_reading(double time_s, const hal::RobotReadings& readings,
                                      std::int64_t now_ns) noexcept {
  control::SensorReading reading;
  reading.time_s = time_s;
  for (int i = 0; i < kJoints; ++i) {
    const hal::JointReading& joint = readings.joints[static_cast<std::size_t>(i)];
    reading.joint_position_rad[i] = joint.position_rad;
    reading.joint_velocity_rad_s[i] = joint.velocity_rad_s;
  }
  reading.base_pitch_rad = pitch_now_rad(readings.base, now_ns);
  reading.base_pitch_rate_rad_s = readings.base.pitch_rate_rad_s;
  return reading;
}

model::StateVector measured_state(const control::SensorReading& reading) noexcept {
  model::StateVector state = model::StateVector::Zero();
  state[model::kFirstAngle] = reading.base_pitch_rad;
  state.segment<kJoints>(model::kFirstJoint) = reading.joint_position_rad;
  state[model::kPositions + model::kFirstAngle] = reading.base_pitch_rate_rad_s;
  state.tail<kJoints>() = reading.joint_velocity_rad_s;
  return state;
}

control::SensorReading exact_reading(double time_s, const model::StateVector& state) noexcept {
  control::SensorReading reading;
  reading.time_s = time_s;
  reading.base_pitch_rad = state[model::kFirstAngle];
  reading.joint_position_rad = state.segment<kJoints>(model::kFirstJoint);
  reading.base_pitch_rate_rad_s = state[model::kPositions + model::kFirstAngle];
  reading.joint_velocity_rad_s = state.tail<kJoints>();
  return reading;
}

double hip_height_share(const model::RobotModel& robot, const control::SensorReading& reading) noexcept {
  const model::StateVector state = measured_state(reading);
  model::KinematicsTerms<double> feet;
  robot.kinematics(state.data(), feet);
  const double height_m = -std::min(feet.foot_position[1], feet.foot_position[3]);
  return height_m / (robot.constants.thigh_length_m + robot.constants.shin_length_m);
}

}  // namespace stilt::control_loop
