#include "tests/host_tools/simulation/robot_on_bus/mpc_driver.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tests/robots.h"

namespace stilt::robot_on_bus::testing_support {
namespace {

constexpr double kRamp_s = 0.5;

}  // namespace

MpcDriver::MpcDriver(DrivenRobot& robot) : robot_(robot), timing_(robot.configuration.timing) {
  if (planner_->configure(stilt::testing_support::amber3m(), robot.configuration) !=
      control::ConfigureStatus::ok) {
    throw std::runtime_error("the planner refuses the configuration");
  }
  estimator_.configure(stilt::testing_support::amber3m(), robot.configuration.estimator);
  law_.configure(stilt::testing_support::amber3m(), robot.configuration);
  estimator_.reset(reading(), 0.0);
  planner_->reset(0.0);
}

control::SensorReading MpcDriver::reading() const {
  control::SensorReading reading;
  reading.time_s = time_s();
  for (int joint = 0; joint < model::kJoints; ++joint) {
    reading.joint_position_rad[joint] = robot_.readings[static_cast<std::size_t>(joint)].position_rad;
    reading.joint_velocity_rad_s[joint] = robot_.readings[static_cast<std::size_t>(joint)].velocity_rad_s;
  }
  reading.base_pitch_rad = robot_.base.pitch_rad;
  reading.base_pitch_rate_rad_s = robot_.base.pitch_rate_rad_s;
  return reading;
}

void MpcDriver::tick(const gait::GaitCommand& command) {
  if (ticks_ == next_at_) std::swap(active_, next_);
  const control::SensorReading now = reading();
  control::PlanPoint point;
  point.mode = {true, true};
  if (active_->nodes >= 2) point = control::interpolate(*active_, now.time_s);
  const model::StateVector estimate = estimator_.update(now, point.mode);
  model::JointVector torque_Nm = model::JointVector::Zero();
  if (active_->nodes >= 2) {
    torque_Nm = law_.follow(now, estimate, point).torque_Nm;
  }
  if (ticks_ % timing_.period_ticks == 0) {
    const bool usable = planner_->plan({now.time_s, estimate, command}, *next_).usable();
    next_at_ = usable ? ticks_ + timing_.delay_ticks : -1;
  }
  const double ramp = std::min(1.0, time_s() / kRamp_s);
  hal::JointCommands commands;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    commands[joint].torque_Nm = ramp * torque_Nm[static_cast<int>(joint)];
    commands[joint].torque_limit_Nm = 80.0;
  }
  robot_.tick(&commands);
  ++ticks_;
}

}  // namespace stilt::robot_on_bus::testing_support
