#include "hal/robot/can_robot.h"

#include <algorithm>
#include <cmath>
#include <optional>

// Layers of the hardware abstraction: docs/decisions/0004-hardware-abstraction.md
namespace stilt::hal {
namespace {

constexpr std::uint32_t kOldReading = 5;        // reads: then an old velocity would push instead of damp
constexpr std::uint64_t kQuestionsEvery = 100;  // writes
constexpr unsigned kQuestions = 2;              // to each driver
constexpr int kMaximumRounds = 8;  // batches per bus and tick: bounds the time of a read on a babbling bus

bool usable(EncodeStatus status) noexcept {
  return status == EncodeStatus::ok || status == EncodeStatus::saturated;
}

bool finite(const JointCommand& command) noexcept {
  return std::isfinite(command.position_rad) && std::isfinite(command.velocity_rad_s) &&
         std::isfinite(command.torque_Nm) && std::isfinite(command.kp_Nm_rad) &&
         std::isfinite(command.kd_Nms_rad) && std::isfinite(command.torque_limit_Nm);
}

}  // namespace

CanRobot::CanRobot(const RobotWiring& wiring, std::span<FrameBus* const> buses) noexcept
    : wiring_(wiring), torso_(torso_sensor_traits(wiring)), pitch_is_channel_(hal::pitch_is_channel(wiring)) {
  bus_count_ = std::min(buses.size(), buses_.size());
  std::copy_n(buses.begin(), bus_count_, buses_.begin());
  const auto rows = std::span(wiring_.channels).first(wiring_.channel_count);
  has_emergency_stop_ = std::any_of(rows.begin(), rows.end(), [](const auto& row) {
    return row.channel == BaseChannel::emergency_stop_released;
  });
  if (wiring_.pitch_encoder)
    encoder_.emplace(*wiring_.pitch_encoder, static_cast<std::uint32_t>(wiring_.channel_period_ticks));
}

JointBusStatus CanRobot::bus_status() const noexcept {
  JointBusStatus status = JointBusStatus::ok;
  for (const FrameBus* bus : std::span(buses_).first(bus_count_)) {
    if (bus->health() == BusHealth::off) status = JointBusStatus::bus_off;
  }
  return status;
}

JointBusStatus CanRobot::read(std::int64_t now_ns, JointReadings& readings) noexcept {
  fresh_.fill(false);
  was_idle_.fill(false);
  started_.fill(false);
  torso_.begin_read();
  bool disconnected = false;
  for (std::size_t bus = 0; bus < bus_count_; ++bus) {
    for (int round = 0; round < kMaximumRounds; ++round) {
      const ReceiveResult result = buses_[bus]->receive(received_);
      for (const CanFrame& frame : std::span(received_).first(result.received)) receive(now_ns, bus, frame);
      disconnected = disconnected || result.status == BusStatus::disconnected;
      if (result.status != BusStatus::more) break;
    }
  }
  if (!wrote_) unsent_.fill(0);  // nothing was to leave: drivers are off, or brought up
  wrote_ = false;
  bool complete = true;
  for (std::size_t joint = 0; joint < kJoints; ++joint) complete = !count_missed(joint) && complete;
  take_feed();
  torso_.end_read();
  readings = readings_;
  if (disconnected) return JointBusStatus::disconnected;
  const JointBusStatus status = bus_status();
  return status == JointBusStatus::ok && !complete ? JointBusStatus::incomplete : status;
}

/// A driver that reports by its own clock is only missed once its next report is due.
std::uint32_t CanRobot::missed_reports(std::size_t joint) const noexcept {
  const auto between = static_cast<std::uint32_t>(wiring_.joints[joint].report_period_ticks - 1);
  return silent_reads_[joint] > between ? silent_reads_[joint] - between : 0;
}

/// Such a driver reports also while no command reaches it. So those that do not leave count as well.
bool CanRobot::count_missed(std::size_t joint) noexcept {
  silent_reads_[joint] = fresh_[joint] ? 0 : silent_reads_[joint] + 1;
  const JointWiring& wiring = wiring_.joints[joint];
  const std::uint32_t missed_commands = reports_by_itself(wiring.driver) ? unsent_[wiring.bus] : 0;
  readings_[joint].missed_replies = std::max(missed_reports(joint), missed_commands);
  return missed_reports(joint) > 0;
}

void CanRobot::receive(std::int64_t now_ns, std::size_t bus, const CanFrame& frame) noexcept {
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    if (wiring_.joints[joint].bus != bus) continue;
    const DecodeStatus status = take_joint(now_ns, joint, frame);
    if (status == DecodeStatus::not_addressed) continue;
    if (status != DecodeStatus::ok) ++readings_[joint].malformed;
    return;
  }
  if (bus == wiring_.channel_bus) take_channels(now_ns, frame);
  if (encoder_ && bus == wiring_.pitch_encoder_bus) take_torso_encoder(now_ns, frame);
}

DecodeStatus CanRobot::take_joint(std::int64_t now_ns, std::size_t joint, const CanFrame& frame) noexcept {
  const JointWiring& wiring = wiring_.joints[joint];
  DriverReading& shaft = shafts_[joint];
  shaft.begin_frame();
  const DecodeStatus status =
      visit_driver(wiring.driver, [&](const auto& driver) { return take_frame(driver, frame, shaft); });
  if (status != DecodeStatus::ok) return status;
  JointReading& reading = readings_[joint];
  started_[joint] = started_[joint] || shaft.has_started;
  if (shaft.has_motion) set_motion(now_ns, joint);
  if (!std::isnan(shaft.torque_Nm))
    reading.torque_Nm = wiring.direction * wiring.ratio * wiring.torque_factor * shaft.torque_Nm;
  reading.driver_temperature_C = shaft.driver_temperature_C;
  reading.motor_temperature_C = shaft.motor_temperature_C;
  reading.supply_V = shaft.supply_V;
  reading.state = state_of(joint);
  reading.fault = shaft.fault;
  reading.fault_code = shaft.fault_code;
  if (wiring_.pitch_encoder_joint == static_cast<int>(joint) && std::isfinite(shaft.encoder_position_rad))
    set_torso_pitch(now_ns, shaft.encoder_position_rad, shaft.encoder_velocity_rad_s);
  return status;
}

/// An AK of version 3 reports once that it has started or was disabled, and then nothing of its state. Within
/// a read, later frames without a state do not undo that report.
DriverState CanRobot::state_of(std::size_t joint) noexcept {
  const DriverState state = shafts_[joint].state;
  was_idle_[joint] = was_idle_[joint] || state == DriverState::idle;
  return was_idle_[joint] && state == DriverState::unknown ? DriverState::idle : state;
}

void CanRobot::set_motion(std::int64_t now_ns, std::size_t joint) noexcept {
  const JointWiring& wiring = wiring_.joints[joint];
  const DriverReading& shaft = shafts_[joint];
  JointReading& reading = readings_[joint];
  const double position_rad =
      wiring.direction * (shaft.position_rad + turn_offset_rad_[joint]) / wiring.ratio + wiring.offset_rad;
  const double velocity_rad_s = wiring.direction * shaft.velocity_rad_s / wiring.ratio;
  const bool same = position_rad == reading.position_rad && velocity_rad_s == reading.velocity_rad_s;
  reading.unchanged_replies = same ? reading.unchanged_replies + 1 : 0;
  reading.position_rad = position_rad;
  reading.velocity_rad_s = velocity_rad_s;
  reading.time_ns = now_ns;
  fresh_[joint] = true;
}

void CanRobot::take_feed() noexcept {
  if (feed_ == nullptr) return;
  const TorsoSample& newest = feed_->newest();
  torso_.reading().malformed += newest.malformed - sample_.malformed;
  if (newest.number != sample_.number) {
    if (std::isfinite(newest.pitch_rate_rad_s)) torso_.set_rate(newest.pitch_rate_rad_s);
    torso_.set_pitch(newest.time_ns, newest.pitch_rad);
  }
  sample_ = newest;
}

void CanRobot::take_torso_encoder(std::int64_t now_ns, const CanFrame& frame) noexcept {
  canopen::EncoderPosition position;
  const DecodeStatus status = encoder_->take(now_ns, frame, position);
  if (status == DecodeStatus::ok) set_torso_pitch(position.time_ns, position.angle_rad, position.speed_rad_s);
  if (status != DecodeStatus::ok && status != DecodeStatus::not_addressed) ++torso_.reading().malformed;
}

/// Of the encoder's shaft. @param speed_rad_s  NaN: not reported
void CanRobot::set_torso_pitch(std::int64_t time_ns, double angle_rad, double speed_rad_s) noexcept {
  const double turns = wiring_.pitch_direction / wiring_.pitch_ratio;
  if (std::isfinite(speed_rad_s)) torso_.set_rate(turns * speed_rad_s);
  torso_.set_pitch(time_ns, turns * angle_rad + wiring_.pitch_offset_rad);
}

void CanRobot::take_channels(std::int64_t now_ns, const CanFrame& frame) noexcept {
  ChannelValues values;
  const DecodeStatus status = decode(std::span(wiring_.channels).first(wiring_.channel_count), frame, values);
  if (status == DecodeStatus::not_addressed) return;
  BaseReading& base = torso_.reading();
  if (status != DecodeStatus::ok) {
    ++base.malformed;
    return;
  }
  const auto set = [&values](BaseChannel channel, double& field) {
    if (values.has(channel)) field = values[channel];
  };
  set(BaseChannel::acceleration_x_m_s2, base.acceleration_x_m_s2);
  set(BaseChannel::acceleration_z_m_s2, base.acceleration_z_m_s2);
  set(BaseChannel::left_foot_force_N, base.left_foot_force_N);
  set(BaseChannel::right_foot_force_N, base.right_foot_force_N);
  if (pitch_is_channel_ && values.has(BaseChannel::pitch_rate_rad_s))
    torso_.set_rate(values[BaseChannel::pitch_rate_rad_s]);
  if (pitch_is_channel_ && values.has(BaseChannel::pitch_rad))
    torso_.set_pitch(now_ns, values[BaseChannel::pitch_rad]);
  if (values.has(BaseChannel::emergency_stop_released)) {
    emergency_stop_released_ = values[BaseChannel::emergency_stop_released] != 0;
    emergency_stop_time_ns_ = now_ns;
  }
}

DriverCommand CanRobot::at_shaft(std::size_t joint, const JointCommand& command) const noexcept {
  const JointWiring& wiring = wiring_.joints[joint];
  const JointReading& reading = readings_[joint];
  const double turns = wiring.direction * wiring.ratio;
  const double torque_ratio =
      wiring.ratio * wiring.torque_factor;  // of the joint to that asked of the driver
  const double gain_ratio = wiring.ratio * torque_ratio;
  const double limit_Nm = std::abs(command.torque_limit_Nm);
  const double feedback_Nm = command.kp_Nm_rad * (command.position_rad - reading.position_rad) +
                             command.kd_Nms_rad * (command.velocity_rad_s - reading.velocity_rad_s);
  const double law_Nm = command.torque_Nm + (silent_reads_[joint] > kOldReading ? 0 : feedback_Nm);
  const double limited_Nm = has_no_feedback(joint) ? 0 : std::clamp(law_Nm, -limit_Nm, limit_Nm);
  return {.position_rad = turns * (command.position_rad - wiring.offset_rad) - turn_offset_rad_[joint],
          .velocity_rad_s = turns * command.velocity_rad_s,
          .torque_Nm = wiring.direction * command.torque_Nm / torque_ratio,
          .kp_Nm_rad = command.kp_Nm_rad / gain_ratio,
          .kd_Nms_rad = command.kd_Nms_rad / gain_ratio,
          .torque_limit_Nm = limit_Nm / torque_ratio,
          .watchdog_s = wiring_.driver_watchdog_s,
          .law_Nm = wiring.direction * limited_Nm / torque_ratio};
}

/// Whether the law of this joint is computed here, and there is no reading to compute it with.
bool CanRobot::has_no_feedback(std::size_t joint) const noexcept {
  const JointReading& reading = readings_[joint];
  const bool has_gains =
      visit_driver(wiring_.joints[joint].driver, [](const auto& driver) { return has_own_gains(driver); });
  return !has_gains && !(std::isfinite(reading.position_rad) && std::isfinite(reading.velocity_rad_s));
}

JointBusStatus CanRobot::write(const JointCommands& commands) noexcept {
  if (!std::all_of(commands.begin(), commands.end(), finite)) return JointBusStatus::refused;
  std::array<CanFrame, kJoints> frames;
  bool all_have_feedback = true;
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    all_have_feedback = all_have_feedback && !has_no_feedback(joint);
    DriverCommand command = at_shaft(joint, commands[joint]);
    command.asks_motor_temperature = writes_ % kQuestionsEvery == joint;
    const EncodeStatus status = visit_driver(wiring_.joints[joint].driver, [&](const auto& driver) {
      return command_frame(driver, command, frames[joint]);
    });
    if (!usable(status)) return JointBusStatus::refused;
  }
  const JointBusStatus status = send(frames);
  ask_drivers();
  return status == JointBusStatus::ok && !all_have_feedback ? JointBusStatus::incomplete : status;
}

/// One question per write, to one driver after the other.
void CanRobot::ask_drivers() noexcept {
  const std::uint64_t turn = writes_++ % kQuestionsEvery;
  const auto joint = static_cast<std::size_t>(turn / kQuestions);
  if (joint >= kJoints) return;
  const JointWiring& wiring = wiring_.joints[joint];
  const auto question = static_cast<unsigned>(turn % kQuestions);
  const std::optional<CanFrame> frame = visit_driver(
      wiring.driver, [question](const auto& driver) { return question_frame(driver, question); });
  if (!frame) return;
  static_cast<void>(buses_[wiring.bus]->send(std::span(&*frame, 1)));  // asked again soon
}

JointBusStatus CanRobot::disable() noexcept {
  std::array<CanFrame, kJoints> frames;
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const EncodeStatus status = visit_driver(wiring_.joints[joint].driver, [&](const auto& driver) {
      return disable_frame(driver, frames[joint]);
    });
    if (!usable(status)) return JointBusStatus::refused;  // only with invalid wiring
  }
  return send(frames);
}

void CanRobot::clear_faults() noexcept {
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const JointReading& reading = readings_[joint];
    const bool faulty = reading.fault != DriverFault::none || reading.state == DriverState::fault;
    if (!faulty && missed_reports(joint) <= kOldReading) continue;
    const JointWiring& wiring = wiring_.joints[joint];
    CanFrame frame;
    const bool usable_frame = visit_driver(wiring.driver, [&frame](const auto& driver) {
      const std::optional<CanFrame> reset = fault_reset_frame(driver);
      if (reset) frame = *reset;
      return reset || usable(disable_frame(driver, frame));
    });
    if (usable_frame) static_cast<void>(buses_[wiring.bus]->send(std::span(&frame, 1)));
  }
}

JointBusStatus CanRobot::send(const std::array<CanFrame, kJoints>& frames) noexcept {
  JointBusStatus status = bus_status();
  wrote_ = true;
  for (std::size_t bus = 0; bus < bus_count_; ++bus) {
    std::array<CanFrame, kJoints> batch;
    std::size_t count = 0;
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      if (wiring_.joints[joint].bus == bus) batch[count++] = frames[joint];
    }
    if (count == 0) continue;
    const SendResult result = buses_[bus]->send(std::span(batch).first(count));
    // Behind a slow adapter the frames of joints may leave by turns: each reaches its driver often enough.
    unsent_[bus] = result.sent > 0 ? 0 : unsent_[bus] + 1;
    if (result.status == BusStatus::disconnected) status = JointBusStatus::disconnected;
    if (result.sent < count && status == JointBusStatus::ok) status = JointBusStatus::incomplete;
  }
  return status;
}

TorsoSensorStatus CanRobot::read_base(BaseReading& reading) noexcept {
  reading = torso_.reading();
  return torso_.pitch_is_new() ? TorsoSensorStatus::ok : TorsoSensorStatus::stale;
}

void CanRobot::serve_torso_sensor(std::int64_t now_ns) noexcept {
  if (!encoder_) return;
  const std::optional<CanFrame> frame = encoder_->step(now_ns);
  if (!frame) return;
  static_cast<void>(buses_[wiring_.pitch_encoder_bus]->send(std::span(&*frame, 1)));  // sent again soon
}

EmergencyStopState CanRobot::read_emergency_stop(std::int64_t now_ns) noexcept {
  if (!has_emergency_stop_) return EmergencyStopState::absent;
  const bool recent =
      emergency_stop_time_ns_ != 0 && now_ns - emergency_stop_time_ns_ <= wiring_.emergency_stop_timeout_ns;
  if (!recent) return EmergencyStopState::unknown;
  return emergency_stop_released_ ? EmergencyStopState::released : EmergencyStopState::pressed;
}

}  // namespace stilt::hal
