#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"

#include <algorithm>
#include <cmath>
#include <utility>

// Simulated robot behind its buses: docs/decisions/0007-robot-on-the-bus.md
namespace stilt::robot_on_bus {
namespace {

using hal::BaseChannel;

constexpr double kTorqueOn_Nm = 3.0;  // more than a damped, hanging leg needs
constexpr double kSittingHip = 0.85;  // share of the nominal height
constexpr double kLoaded_N = 5.0;
constexpr double kUpright_rad = 0.3;
constexpr double kSlow_m_s = 0.5;  // a damped robot that collapses is faster
constexpr int kSittingTicks = 20;
constexpr double kSupply_V = 48.0;

double& channel(BaseValues& values, BaseChannel which) { return values[static_cast<std::size_t>(which)]; }

}  // namespace

RobotOnBus::RobotOnBus(const RobotSetup& setup)
    : setup_(setup),
      plant_(setup.model, setup.plant, setup.seed),
      steps_per_tick_(static_cast<int>(std::lround(setup.tick_s / plant_.time_step_s()))),
      drivers_(setup.wiring, setup.mistakes),
      torso_sensor_(setup.wiring),
      gantry_(setup.gantry, setup.standing, plant_.mass_kg() * model::kGravity_m_s2),
      line_(setup.faults),
      recorder_(setup.keep_samples),
      fault_active_(setup.faults.size(), false) {
  if (setup.wiring.pitch_encoder) torso_encoder_.emplace(*setup.wiring.pitch_encoder);
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint)
    drivers_.driver(joint).motor.supply_V = kSupply_V;
  plant_.set_state(gantry_.hanging());
  for (int joint = 0; joint < model::kJoints; ++joint) {
    const int angle = model::kFirstJoint + joint;
    if (setup.mistakes[static_cast<std::size_t>(joint)].blocked)
      obstacles_.move(angle, plant_.state()[angle]);
  }
  read_encoders();
}

std::optional<double> RobotOnBus::walk_time_s() const {
  if (!release_tick_) return std::nullopt;
  return static_cast<double>(ticks_ - *release_tick_) * setup_.tick_s;
}

std::optional<double> RobotOnBus::gantry_released_s() const {
  if (!release_tick_) return std::nullopt;
  return static_cast<double>(*release_tick_) * setup_.tick_s;
}

void RobotOnBus::receive(std::int64_t now_ns, std::size_t bus, const hal::CanFrame& frame) {
  if (bus_off_[bus]) return;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (drivers_.bus(joint) != bus || line_.lost(fault_clock_s_, bus, joint)) continue;
    hal::FrameSink replies;
    drivers_.driver(joint).take(now_ns, drivers_.flexible(bus).from_bus(frame), replies);
    send_from_driver(now_ns, joint, replies);
  }
  if (!torso_encoder_ || setup_.wiring.pitch_encoder_bus != bus) return;
  hal::FrameSink replies;
  torso_encoder_->take(now_ns, frame, replies);
  send_from_torso(now_ns, bus, replies);
}

void RobotOnBus::send_from_driver(std::int64_t now_ns, std::size_t joint, const hal::FrameSink& frames) {
  const std::size_t bus = drivers_.bus(joint);
  for (const hal::CanFrame& frame : frames.frames())
    line_.send(fault_clock_s_, now_ns, {bus, joint}, drivers_.flexible(bus).to_bus(frame));
}

void RobotOnBus::send_from_torso(std::int64_t now_ns, std::size_t bus, const hal::FrameSink& frames) {
  if (active(simulation::FaultKind::base_silent)) return;
  for (const hal::CanFrame& frame : frames.frames())
    line_.send(fault_clock_s_, now_ns, {bus, std::nullopt}, frame);
}

void RobotOnBus::set_torso_encoder(double pitch_rad, double pitch_rate_rad_s) {
  if (!torso_encoder_) return;
  const double turns = setup_.wiring.pitch_direction * setup_.wiring.pitch_ratio;
  torso_encoder_->set_motion(turns * (pitch_rad - setup_.wiring.pitch_offset_rad), turns * pitch_rate_rad_s);
}

std::vector<hal::CanFrame> RobotOnBus::take_outgoing(std::int64_t now_ns, std::size_t bus) {
  std::vector<hal::CanFrame> frames = line_.arrived(now_ns, bus);
  if (bus_off_[bus]) std::erase_if(frames, [](const hal::CanFrame& frame) { return !frame.error; });
  return frames;
}

void RobotOnBus::tick(std::int64_t now_ns) {
  for (int i = 0; i < steps_per_tick_; ++i) step(now_ns);
}

void RobotOnBus::step(std::int64_t now_ns) {
  if (step_in_tick_ == 0) inject_faults(now_ns);
  act();
  plant_.step();
  read_encoders();
  recorder_.observe_step(plant_);
  if (++step_in_tick_ < steps_per_tick_) return;
  step_in_tick_ = 0;
  finish_tick(now_ns);
}

/// Sets the encoders of joints and torso from the plant's sensors.
void RobotOnBus::read_encoders() {
  const control::SensorReading reading = plant_.read_sensors();
  for (int joint = 0; joint < model::kJoints; ++joint) {
    drivers_.set_motion(static_cast<std::size_t>(joint), reading.joint_position_rad[joint],
                        reading.joint_velocity_rad_s[joint]);
  }
  if (active(simulation::FaultKind::base_freeze)) return;
  drivers_.set_pitch(reading.base_pitch_rad, reading.base_pitch_rate_rad_s);
  set_torso_encoder(reading.base_pitch_rad, reading.base_pitch_rate_rad_s);
  channel(base_values_, BaseChannel::pitch_rad) = reading.base_pitch_rad;
  channel(base_values_, BaseChannel::pitch_rate_rad_s) = reading.base_pitch_rate_rad_s;
}

/// Applies motors, pushes and the gantry to the plant.
void RobotOnBus::act() {
  model::JointVector torque_Nm;
  for (int joint = 0; joint < model::kJoints; ++joint) {
    torque_Nm[joint] = drivers_.torque_Nm(static_cast<std::size_t>(joint));
  }
  plant_.command_torque(torque_Nm);
  const simulation::ActingPush push = push_at(setup_.pushes, clock_s());
  plant_.set_push(push.force_N, push.point);
  const model::StateVector state = plant_.state();
  hands_.elapse(state, time_step_s());
  obstacles_.elapse(state, time_step_s());
  plant_.set_surroundings_force(gantry_.force(state) + hands_.force(state) + obstacles_.force(state));
}

void RobotOnBus::finish_tick(std::int64_t now_ns) {
  ++ticks_;
  run_timers(now_ns);
  send_base(now_ns);
  update_rig();
}

void RobotOnBus::run_timers(std::int64_t now_ns) {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    hal::FrameSink frames;
    drivers_.driver(joint).elapse(now_ns, frames);
    send_from_driver(now_ns, joint, frames);
  }
  if (!torso_encoder_) return;
  hal::FrameSink frames;
  torso_encoder_->elapse(now_ns, frames);
  send_from_torso(now_ns, setup_.wiring.pitch_encoder_bus, frames);
}

void RobotOnBus::send_base(std::int64_t now_ns) {
  late_values_.push_back(base_values());
  const BaseValues values = late_values_.front();
  if (time_s() > setup_.torso_sensor_delay_s) late_values_.pop_front();
  if (!base_due() || active(simulation::FaultKind::base_silent)) return;
  for (const hal::CanFrame& frame : torso_sensor_.encode(values)) {
    line_.send(fault_clock_s_, now_ns, {setup_.wiring.channel_bus, std::nullopt}, frame);
  }
  if (setup_.wiring.serial_imu) send_serial(values);
}

void RobotOnBus::send_serial(const BaseValues& values) {
  constexpr std::size_t kMostWaiting = 4096;  // bytes without a reader
  const hal::vectornav::Pitch pitch{values[static_cast<std::size_t>(BaseChannel::pitch_rad)],
                                    values[static_cast<std::size_t>(BaseChannel::pitch_rate_rad_s)]};
  const auto message = hal::vectornav::encode(packet_of(pitch, *setup_.wiring.serial_imu));
  if (serial_bytes_.size() + message.size() <= kMostWaiting)
    serial_bytes_.insert(serial_bytes_.end(), message.begin(), message.end());
}

std::vector<std::uint8_t> RobotOnBus::take_serial() { return std::exchange(serial_bytes_, {}); }

/// Whether a period of the torso sensor, counted from the start, ended with this tick.
bool RobotOnBus::base_due() {
  constexpr double kRounding = 1e-6;
  const auto over = static_cast<std::uint64_t>(time_s() * setup_.torso_sensor_rate_hz + kRounding);
  const bool due = over > base_frames_;
  base_frames_ = over;
  return due;
}

/// Specific force of the hip over the last tick in the base frame: a - g, rotated by the pitch.
BaseValues RobotOnBus::base_values() {
  const model::StateVector state = plant_.state();
  const double vx = state[model::kPositions], vz = state[model::kPositions + 1];
  const double ax = (vx - base_velocity_m_s_[0]) / setup_.tick_s;
  const double az = (vz - base_velocity_m_s_[1]) / setup_.tick_s + model::kGravity_m_s2;
  base_velocity_m_s_[0] = vx;
  base_velocity_m_s_[1] = vz;
  channel(base_values_, BaseChannel::emergency_stop_released) =
      active(simulation::FaultKind::emergency_stop) ? 0.0 : 1.0;
  if (active(simulation::FaultKind::base_freeze)) return base_values_;
  const double sine = std::sin(state[model::kFirstAngle]), cosine = std::cos(state[model::kFirstAngle]);
  channel(base_values_, BaseChannel::acceleration_x_m_s2) = cosine * ax - sine * az;
  channel(base_values_, BaseChannel::acceleration_z_m_s2) = sine * ax + cosine * az;
  channel(base_values_, BaseChannel::left_foot_force_N) = plant_.contact_force_N()[1];
  channel(base_values_, BaseChannel::right_foot_force_N) = plant_.contact_force_N()[3];
  return base_values_;
}

bool RobotOnBus::torque_on() const {
  return drivers_.all_enabled() && plant_.applied_torque_Nm().cwiseAbs().maxCoeff() >= kTorqueOn_Nm;
}

/// Whether the robot lowers itself under control: motors are enabled, both feet carry load, the torso is
/// upright and slow. This is not a fall; the gantry takes the weight.
bool RobotOnBus::sits_down() const {
  const model::StateVector state = plant_.state();
  const double hip_m = state[1] - plant_.ground_height_m(state[0]);
  const model::FeetVector& force_N = plant_.contact_force_N();
  return hip_m < kSittingHip * setup_.model.nominal_hip_height_m && drivers_.all_enabled() &&
         force_N[1] > kLoaded_N && force_N[3] > kLoaded_N &&
         std::abs(state[model::kFirstAngle]) < kUpright_rad &&
         std::abs(state[model::kPositions]) < kSlow_m_s && std::abs(state[model::kPositions + 1]) < kSlow_m_s;
}

/// Updates the gantry and the statistics.
void RobotOnBus::update_rig() {
  gantry_.elapse(plant_.state(), torque_on(), setup_.tick_s);
  if (gantry_.state() != GantryState::off) return;
  if (!release_tick_) {
    release_tick_ = ticks_;
    recorder_.begin(plant_);
  }
  recorder_.observe_tick(clock_s(), plant_, push_at(setup_.pushes, clock_s()));
  sitting_ticks_ = sits_down() ? sitting_ticks_ + 1 : 0;
  if (sitting_ticks_ >= kSittingTicks) {
    if (!sat_down_s_ && recorder_.running()) sat_down_s_ = clock_s();
    end_walk(simulation::Fall::none);
  } else if (plant_.fall() != simulation::Fall::none) {
    end_walk(plant_.fall());
  }
}

void RobotOnBus::end_walk(simulation::Fall fall) {
  sitting_ticks_ = 0;
  recorder_.finish(clock_s(), plant_, fall);
  gantry_.take(plant_.state());
}

void RobotOnBus::finish() { recorder_.finish(clock_s(), plant_, simulation::Fall::none); }

}  // namespace stilt::robot_on_bus
