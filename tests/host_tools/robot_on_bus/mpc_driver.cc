#include "tests/host_tools/robot_on_bus/mpc_driver.h"

#include <algorithm>
#include <stdexcept>

namespace stilt::robot_on_bus::testing_support {
namespace {

constexpr double kRamp_s = 0.5;

}  // namespace

MpcDriver::MpcDriver(DrivenRobot& robot) : robot_(robot), schedule_(robot.configuration.timing) {
  if (controller_->configure(model::amber3m(), robot.configuration) != control::ConfigureStatus::ok) {
    throw std::runtime_error("the planner refuses the configuration");
  }
  const control::SensorReading now = reading();
  model::StateVector state = model::StateVector::Zero();
  state[model::kFirstAngle] = now.base_pitch_rad;
  state.segment<model::kJoints>(model::kFirstJoint) = now.joint_position_rad;
  controller_->reset(state, 0.0);
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
  if (ticks_ == adopt_at_) controller_->adopt_plan();
  const simulator::TickOutput output = controller_->tick(reading(), nullptr);
  if (ticks_ % schedule_.plan_period_ticks == 0) {
    static_cast<void>(controller_->plan(time_s(), command));
    adopt_at_ = ticks_ + schedule_.plan_delay_ticks;
  }
  const double ramp = std::min(1.0, time_s() / kRamp_s);
  hal::JointCommands commands;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    commands[joint].torque_Nm = ramp * output.torque_Nm[static_cast<int>(joint)];
    commands[joint].torque_limit_Nm = 80.0;
  }
  robot_.tick(&commands);
  ++ticks_;
}

}  // namespace stilt::robot_on_bus::testing_support
