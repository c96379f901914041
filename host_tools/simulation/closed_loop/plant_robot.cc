#include "host_tools/simulation/closed_loop/plant_robot.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stilt::simulation {
namespace {

constexpr double kSupply_V = 48.0;
constexpr double kLowSupply_V = 30.0;
constexpr double kTemperature_C = 30.0;
constexpr double kHot_C = 120.0;

bool finite(const hal::JointCommand& command) {
  return std::isfinite(command.position_rad) && std::isfinite(command.velocity_rad_s) &&
         std::isfinite(command.torque_Nm) && std::isfinite(command.kp_Nm_rad) &&
         std::isfinite(command.kd_Nms_rad) && std::isfinite(command.torque_limit_Nm);
}

}  // namespace

PlantRobot::PlantRobot(Plant& plant, std::vector<TimedFault> faults, double tick_s)
    : plant_(plant),
      faults_(std::move(faults)),
      sensed_(1 + static_cast<std::size_t>(std::lround(plant.reading_delay_s() / tick_s))) {
  enabled_.fill(true);
}

bool PlantRobot::active(FaultKind kind) const noexcept {
  return std::ranges::any_of(
      faults_, [&](const TimedFault& fault) { return fault.kind == kind && fault.active(time_s_); });
}

bool PlantRobot::active(FaultKind kind, std::size_t joint) const noexcept {
  return std::ranges::any_of(faults_, [&](const TimedFault& fault) {
    return fault.kind == kind && fault.active(time_s_) && (!fault.joint || *fault.joint == joint);
  });
}

void PlantRobot::set_time(double time_s) {
  time_s_ = time_s;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (active(FaultKind::driver_fault, joint) || active(FaultKind::power_cycle, joint)) {
      enabled_[joint] = false;
    }
  }
}

void PlantRobot::drive() {
  const model::StateVector state = plant_.state();
  model::JointVector torque_Nm = model::JointVector::Zero();
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (!enabled_[joint] || active(FaultKind::torque_loss, joint)) continue;
    const hal::JointCommand& command = commands_[joint];
    const auto j = static_cast<int>(joint);
    // A frozen encoder misleads the driver, too.
    const bool frozen = sensing_ && active(FaultKind::encoder_freeze, joint);
    const double position_rad = frozen ? newest().joint_position_rad[j] : state[model::kFirstJoint + j];
    const double velocity_rad_s =
        frozen ? newest().joint_velocity_rad_s[j] : state[model::kPositions + model::kFirstJoint + j];
    const double wanted_Nm = command.torque_Nm + command.kp_Nm_rad * (command.position_rad - position_rad) +
                             command.kd_Nms_rad * (command.velocity_rad_s - velocity_rad_s);
    torque_Nm[j] = std::clamp(wanted_Nm, -command.torque_limit_Nm, command.torque_limit_Nm);
  }
  plant_.command_torque(torque_Nm);
}

const control::SensorReading& PlantRobot::newest() const noexcept {
  return sensed_[(next_ + sensed_.size() - 1) % sensed_.size()];
}

void PlantRobot::read_joint(std::size_t joint, std::int64_t now_ns, const control::SensorReading& sensors,
                            hal::JointReading& reading) const noexcept {
  const auto j = static_cast<int>(joint);
  if (active(FaultKind::power_cycle, joint)) {
    ++reading.missed_replies;
    return;
  }
  const double position_rad = sensors.joint_position_rad[j];
  const double velocity_rad_s = sensors.joint_velocity_rad_s[j];
  const bool same = position_rad == reading.position_rad && velocity_rad_s == reading.velocity_rad_s;
  reading.unchanged_replies = same ? reading.unchanged_replies + 1 : 0;
  reading.position_rad = position_rad;
  reading.velocity_rad_s = velocity_rad_s;
  reading.torque_Nm = plant_.applied_torque_Nm()[j];
  reading.driver_temperature_C = reading.motor_temperature_C =
      active(FaultKind::over_temperature, joint) ? kHot_C : kTemperature_C;
  reading.supply_V = active(FaultKind::low_voltage, joint) ? kLowSupply_V : kSupply_V;
  reading.time_ns = now_ns;
  reading.missed_replies = 0;
  reading.fault =
      active(FaultKind::driver_fault, joint) ? hal::DriverFault::over_current : hal::DriverFault::none;
  reading.state = enabled_[joint] ? hal::DriverState::enabled : hal::DriverState::idle;
  if (reading.fault != hal::DriverFault::none) reading.state = hal::DriverState::fault;
}

void PlantRobot::read_base(std::int64_t now_ns, const control::SensorReading& sensors,
                           hal::BaseReading& reading) const noexcept {
  if (active(FaultKind::base_silent)) {
    ++reading.missed_replies;
    return;
  }
  const bool same = sensors.base_pitch_rad == reading.pitch_rad &&
                    sensors.base_pitch_rate_rad_s == reading.pitch_rate_rad_s;
  reading.unchanged_replies = same ? reading.unchanged_replies + 1 : 0;
  reading.pitch_rad = sensors.base_pitch_rad;
  reading.pitch_rate_rad_s = sensors.base_pitch_rate_rad_s;
  reading.time_ns = now_ns;
  reading.missed_replies = 0;
}

/// Reads the sensors now; frozen sensors keep their values. The first readings fill the delay line.
void PlantRobot::sense() {
  control::SensorReading now = plant_.read_sensors();
  const control::SensorReading& before = newest();
  for (std::size_t joint = 0; sensing_ && joint < hal::kJoints; ++joint) {
    if (!active(FaultKind::encoder_freeze, joint)) continue;
    const auto j = static_cast<int>(joint);
    now.joint_position_rad[j] = before.joint_position_rad[j];
    now.joint_velocity_rad_s[j] = before.joint_velocity_rad_s[j];
  }
  if (sensing_ && active(FaultKind::base_freeze)) {
    now.base_pitch_rad = before.base_pitch_rad;
    now.base_pitch_rate_rad_s = before.base_pitch_rate_rad_s;
  }
  if (!sensing_) std::ranges::fill(sensed_, now);
  sensing_ = true;
  sensed_[next_] = now;
  next_ = (next_ + 1) % sensed_.size();
}

void PlantRobot::read(std::int64_t now_ns, hal::RobotReadings& readings) noexcept {
  sense();
  const control::SensorReading& sensors = sensed_[next_];
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    read_joint(joint, now_ns, sensors, readings.joints[joint]);
  }
  read_base(now_ns, sensors, readings.base);
  readings.status = hal::JointBusStatus::ok;
  readings.emergency_stop = active(FaultKind::emergency_stop) ? hal::EmergencyStopState::pressed
                                                              : hal::EmergencyStopState::released;
}

hal::JointBusStatus PlantRobot::write(const hal::JointCommands& commands) noexcept {
  if (!std::ranges::all_of(commands, finite)) return hal::JointBusStatus::refused;
  commands_ = commands;
  return hal::JointBusStatus::ok;
}

hal::JointBusStatus PlantRobot::disable() noexcept {
  enabled_.fill(false);
  return hal::JointBusStatus::ok;
}

hal::BringUpProgress PlantRobot::bring_up(std::int64_t) noexcept {
  hal::BringUpProgress progress{.ready = true, .stage = hal::bring_up::Stage::ready};
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    enabled_[joint] = !active(FaultKind::driver_fault, joint) && !active(FaultKind::power_cycle, joint);
    if (!enabled_[joint]) {
      progress = {.failed = true, .joint = joint, .stage = hal::bring_up::Stage::failed};
    }
  }
  commands_ = {};
  return progress;
}

}  // namespace stilt::simulation
