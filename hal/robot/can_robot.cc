#include "hal/robot/can_robot.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stilt::hal {
namespace {

using protocol::BaseChannel;
using protocol::DecodeStatus;
using protocol::EncodeStatus;

constexpr std::uint32_t kOldReading = 5;        // reads: then an old velocity would push instead of damp
constexpr std::uint64_t kQuestionsEvery = 100;  // writes
constexpr int kMaximumRounds = 8;  // batches a bus a tick: bounds the time of a read on a babbling bus

bool usable(EncodeStatus status) noexcept {
  return status == EncodeStatus::ok || status == EncodeStatus::saturated;
}

bool finite(const JointCommand& command) noexcept {
  return std::isfinite(command.position_rad) && std::isfinite(command.velocity_rad_s) &&
         std::isfinite(command.torque_Nm) && std::isfinite(command.kp_Nm_rad) &&
         std::isfinite(command.kd_Nms_rad) && std::isfinite(command.torque_limit_Nm);
}

void take_state(JointReading& reading, DriverState state, DriverFault fault, std::uint32_t code) noexcept {
  reading.state = fault == DriverFault::none ? state : DriverState::fault;
  reading.fault = fault;
  reading.fault_code = code;
}

DriverState moteus_state(std::uint8_t mode) noexcept {
  switch (static_cast<protocol::MoteusMode>(mode)) {
    case protocol::MoteusMode::stopped:
      return DriverState::idle;
    case protocol::MoteusMode::position:
    case protocol::MoteusMode::zero_velocity:
      return DriverState::enabled;
    default:
      return DriverState::unknown;
  }
}

}  // namespace

CanRobot::CanRobot(const RobotWiring& wiring, std::span<FrameBus* const> buses) noexcept : wiring_(wiring) {
  bus_count_ = std::min(buses.size(), buses_.size());
  std::copy_n(buses.begin(), bus_count_, buses_.begin());
  const auto rows = std::span(wiring_.channels).first(wiring_.channel_count);
  has_emergency_stop_ = std::any_of(rows.begin(), rows.end(), [](const protocol::ChannelRow& row) {
    return row.channel == BaseChannel::emergency_stop_released;
  });
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
  base_fresh_ = false;
  bool disconnected = false;
  for (std::size_t bus = 0; bus < bus_count_; ++bus) {
    for (int round = 0; round < kMaximumRounds; ++round) {
      const ReceiveResult result = buses_[bus]->receive(received_);
      for (const CanFrame& frame : std::span(received_).first(result.received)) take(now_ns, bus, frame);
      disconnected = disconnected || result.status == BusStatus::disconnected;
      if (result.status != BusStatus::more) break;
    }
  }
  bool complete = true;
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    readings_[joint].missed = fresh_[joint] ? 0 : readings_[joint].missed + 1;
    complete = complete && fresh_[joint];
  }
  count_missed_base();
  readings = readings_;
  if (disconnected) return JointBusStatus::disconnected;
  const JointBusStatus status = bus_status();
  return status == JointBusStatus::ok && !complete ? JointBusStatus::incomplete : status;
}

/// A sensor slower than the reads is only missed once its next frame is due.
void CanRobot::count_missed_base() noexcept {
  base_silent_ = base_fresh_ ? 0 : base_silent_ + 1;
  const std::uint32_t between = base_period_reads() - 1;
  base_.missed = base_silent_ > between ? base_silent_ - between : 0;
}

std::uint32_t CanRobot::base_period_reads() const noexcept {
  const bool by_channel = wiring_.pitch_encoder_joint < 0;
  return by_channel ? static_cast<std::uint32_t>(wiring_.channel_period_ticks) : 1;
}

void CanRobot::take(std::int64_t now_ns, std::size_t bus, const CanFrame& frame) noexcept {
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    if (wiring_.joints[joint].bus != bus) continue;
    const DecodeStatus status = take_joint(now_ns, joint, frame);
    if (status == DecodeStatus::foreign) continue;
    if (status != DecodeStatus::ok) ++readings_[joint].malformed;
    return;
  }
  if (bus == wiring_.channel_bus) take_channels(now_ns, frame);
}

DecodeStatus CanRobot::take_joint(std::int64_t now_ns, std::size_t joint, const CanFrame& frame) noexcept {
  const auto& driver = wiring_.joints[joint].driver;
  if (const auto* mit = std::get_if<protocol::MitDriver>(&driver))
    return take_mit(now_ns, joint, *mit, frame);
  if (const auto* moteus = std::get_if<protocol::MoteusDriver>(&driver)) {
    return take_moteus(now_ns, joint, *moteus, frame);
  }
  const auto* odrive = std::get_if<OdriveNode>(&driver);
  return odrive != nullptr ? take_odrive(now_ns, joint, odrive->node, frame) : DecodeStatus::foreign;
}

void CanRobot::set_motion(std::int64_t now_ns, std::size_t joint, double shaft_position_rad,
                          double shaft_velocity_rad_s, double shaft_torque_Nm) noexcept {
  const JointWiring& wiring = wiring_.joints[joint];
  JointReading& reading = readings_[joint];
  const double position_rad =
      wiring.direction * (shaft_position_rad + turn_offset_rad_[joint]) / wiring.ratio + wiring.offset_rad;
  const double velocity_rad_s = wiring.direction * shaft_velocity_rad_s / wiring.ratio;
  const bool same = position_rad == reading.position_rad && velocity_rad_s == reading.velocity_rad_s;
  reading.frozen = same ? reading.frozen + 1 : 0;
  reading.position_rad = position_rad;
  reading.velocity_rad_s = velocity_rad_s;
  if (!std::isnan(shaft_torque_Nm)) reading.torque_Nm = wiring.direction * wiring.ratio * shaft_torque_Nm;
  reading.time_ns = now_ns;
  fresh_[joint] = true;
}

DecodeStatus CanRobot::take_mit(std::int64_t now_ns, std::size_t joint, const protocol::MitDriver& driver,
                                const CanFrame& frame) noexcept {
  protocol::MitReply reply;
  const DecodeStatus status = decode_reply(driver, frame, reply);
  if (status != DecodeStatus::ok) return status;
  JointReading& reading = readings_[joint];
  set_motion(now_ns, joint, reply.position_rad, reply.velocity_rad_s, reply.torque_Nm);
  reading.driver_temperature_C = reply.driver_temperature_C;
  reading.motor_temperature_C = reply.motor_temperature_C;
  reading.supply_V = reply.supply_V;
  const DriverState known = reply.enabled ? DriverState::enabled : DriverState::idle;
  take_state(reading, reply.says_enabled ? known : DriverState::unknown, reply.fault, reply.fault_code);
  return status;
}

DecodeStatus CanRobot::take_moteus(std::int64_t now_ns, std::size_t joint,
                                   const protocol::MoteusDriver& driver, const CanFrame& frame) noexcept {
  protocol::MoteusReply reply;
  const DecodeStatus status = decode_reply(driver, frame, reply);
  if (status != DecodeStatus::ok) return status;
  JointReading& reading = readings_[joint];
  if (std::isfinite(reply.position_rad) && std::isfinite(reply.velocity_rad_s)) {
    set_motion(now_ns, joint, reply.position_rad, reply.velocity_rad_s, reply.torque_Nm);
  }
  if (reply.has_fault) {
    reading.driver_temperature_C = reply.temperature_C;
    reading.motor_temperature_C = reply.motor_temperature_C;
    reading.supply_V = reply.voltage_V;
  }
  if (reply.has_mode) {
    const bool expired = reply.mode == static_cast<std::uint8_t>(protocol::MoteusMode::timeout);
    const bool failed = reply.mode == static_cast<std::uint8_t>(protocol::MoteusMode::fault);
    DriverFault fault = DriverFault::none;
    if (expired) fault = DriverFault::lost_communication;
    if (failed) {
      fault = protocol::moteus_fault(reply.fault_code);
      if (fault == DriverFault::none) fault = DriverFault::other;  // in fault mode, whatever the code
    }
    take_state(reading, moteus_state(reply.mode), fault, reply.fault_code);
  }
  if (wiring_.pitch_encoder_joint == static_cast<int>(joint)) {
    const auto encoder = static_cast<std::size_t>(driver.extra_encoder);
    const double angle_rad = reply.encoder_position_rad[encoder];
    const double rate_rad_s = reply.encoder_velocity_rad_s[encoder];
    if (std::isfinite(angle_rad)) {
      if (std::isfinite(rate_rad_s)) base_.pitch_rate_rad_s = wiring_.pitch_direction * rate_rad_s;
      set_pitch(now_ns, wiring_.pitch_direction * angle_rad + wiring_.pitch_offset_rad);
    }
  }
  return status;
}

DecodeStatus CanRobot::take_odrive(std::int64_t now_ns, std::size_t joint, std::uint8_t node,
                                   const CanFrame& frame) noexcept {
  protocol::OdriveCommand command{};
  if (decode_command(node, frame, command) != DecodeStatus::ok || frame.remote) return DecodeStatus::foreign;
  JointReading& reading = readings_[joint];
  DecodeStatus status = DecodeStatus::ok;
  switch (command) {
    case protocol::OdriveCommand::encoder_estimates: {
      protocol::OdriveEstimates estimates;
      status = decode(node, frame, estimates);
      if (status == DecodeStatus::ok) {
        set_motion(now_ns, joint, estimates.position_rad, estimates.velocity_rad_s,
                   std::numeric_limits<double>::quiet_NaN());
      }
      return status;
    }
    case protocol::OdriveCommand::torques: {
      protocol::OdriveTorques torques;
      status = decode(node, frame, torques);
      if (status == DecodeStatus::ok) {
        reading.torque_Nm =
            wiring_.joints[joint].direction * wiring_.joints[joint].ratio * torques.estimate_Nm;
      }
      return status;
    }
    case protocol::OdriveCommand::heartbeat: {
      protocol::OdriveHeartbeat heartbeat;
      status = decode(node, frame, heartbeat);
      if (status != DecodeStatus::ok) return status;
      const bool enabled = heartbeat.state == static_cast<std::uint8_t>(protocol::OdriveState::closed_loop);
      take_state(reading, enabled ? DriverState::enabled : DriverState::idle,
                 protocol::odrive_fault(heartbeat.errors), heartbeat.errors);
      return status;
    }
    case protocol::OdriveCommand::temperature: {
      protocol::OdriveTemperatures temperatures;
      status = decode(node, frame, temperatures);
      if (status != DecodeStatus::ok) return status;
      reading.driver_temperature_C = temperatures.driver_C;
      reading.motor_temperature_C = temperatures.motor_C;
      return status;
    }
    case protocol::OdriveCommand::supply: {
      protocol::OdriveSupply supply;
      status = decode(node, frame, supply);
      if (status == DecodeStatus::ok) reading.supply_V = supply.voltage_V;
      return status;
    }
    default:
      return DecodeStatus::ok;  // of this node, nothing we need
  }
}

/// After the rate of the same moment. A pitch alone stays equal over many readings of a coarse sensor.
void CanRobot::set_pitch(std::int64_t now_ns, double pitch_rad) noexcept {
  const double rate_rad_s = base_.pitch_rate_rad_s;
  const bool same_rate = rate_rad_s == rate_at_pitch_rad_s_ || std::isnan(rate_rad_s);
  const bool same = pitch_rad == base_.pitch_rad && same_rate;
  base_.frozen = same ? base_.frozen + base_period_reads() : 0;
  rate_at_pitch_rad_s_ = rate_rad_s;
  base_.pitch_rad = pitch_rad;
  base_.time_ns = now_ns;
  base_fresh_ = true;
}

void CanRobot::take_channels(std::int64_t now_ns, const CanFrame& frame) noexcept {
  protocol::ChannelValues values;
  const DecodeStatus status =
      protocol::decode(std::span(wiring_.channels).first(wiring_.channel_count), frame, values);
  if (status == DecodeStatus::foreign) return;
  if (status != DecodeStatus::ok) {
    ++base_.malformed;
    return;
  }
  const auto set = [&values](BaseChannel channel, double& field) {
    if (values.has(channel)) field = values[channel];
  };
  set(BaseChannel::pitch_rate_rad_s, base_.pitch_rate_rad_s);
  set(BaseChannel::acceleration_x_m_s2, base_.acceleration_x_m_s2);
  set(BaseChannel::acceleration_z_m_s2, base_.acceleration_z_m_s2);
  set(BaseChannel::left_foot_force_N, base_.left_foot_force_N);
  set(BaseChannel::right_foot_force_N, base_.right_foot_force_N);
  if (values.has(BaseChannel::pitch_rad)) set_pitch(now_ns, values[BaseChannel::pitch_rad]);
  if (values.has(BaseChannel::emergency_stop_released)) {
    emergency_stop_released_ = values[BaseChannel::emergency_stop_released] != 0;
    emergency_stop_time_ns_ = now_ns;
  }
}

EncodeStatus CanRobot::encode(std::size_t joint, const JointCommand& command,
                              CanFrame& frame) const noexcept {
  const JointWiring& wiring = wiring_.joints[joint];
  const double squared_ratio = wiring.ratio * wiring.ratio;
  const double position_rad =
      wiring.direction * wiring.ratio * (command.position_rad - wiring.offset_rad) - turn_offset_rad_[joint];
  const double velocity_rad_s = wiring.direction * wiring.ratio * command.velocity_rad_s;
  const double torque_Nm = wiring.direction * command.torque_Nm / wiring.ratio;
  const double kp_Nm_rad = command.kp_Nm_rad / squared_ratio;
  const double kd_Nms_rad = command.kd_Nms_rad / squared_ratio;
  if (const auto* mit = std::get_if<protocol::MitDriver>(&wiring.driver)) {
    return encode_command(*mit, {position_rad, velocity_rad_s, kp_Nm_rad, kd_Nms_rad, torque_Nm}, frame);
  }
  if (const auto* moteus = std::get_if<protocol::MoteusDriver>(&wiring.driver)) {
    const double limit_Nm = std::abs(command.torque_limit_Nm) / wiring.ratio;
    return encode_command(
        *moteus,
        {position_rad, velocity_rad_s, torque_Nm, kp_Nm_rad, kd_Nms_rad, limit_Nm, wiring_.driver_watchdog_s},
        frame);
  }
  const auto* odrive = std::get_if<OdriveNode>(&wiring.driver);
  const JointReading& reading = readings_[joint];
  const double feedback_Nm = command.kp_Nm_rad * (command.position_rad - reading.position_rad) +
                             command.kd_Nms_rad * (command.velocity_rad_s - reading.velocity_rad_s);
  const double law_Nm = command.torque_Nm + (reading.missed > kOldReading ? 0 : feedback_Nm);
  const double limit_Nm = std::abs(command.torque_limit_Nm);
  const double limited_Nm = blind(joint) ? 0 : std::clamp(law_Nm, -limit_Nm, limit_Nm);
  return protocol::encode_input_torque(odrive->node, wiring.direction * limited_Nm / wiring.ratio, frame);
}

/// Whether the law of this joint is computed here, and there is no reading to compute it with.
bool CanRobot::blind(std::size_t joint) const noexcept {
  const JointReading& reading = readings_[joint];
  return std::holds_alternative<OdriveNode>(wiring_.joints[joint].driver) &&
         !(std::isfinite(reading.position_rad) && std::isfinite(reading.velocity_rad_s));
}

EncodeStatus CanRobot::encode_disable(std::size_t joint, CanFrame& frame) const noexcept {
  const auto& driver = wiring_.joints[joint].driver;
  if (const auto* mit = std::get_if<protocol::MitDriver>(&driver)) {
    frame = special_frame(*mit, protocol::MitSpecial::leave);
    return EncodeStatus::ok;
  }
  if (const auto* moteus = std::get_if<protocol::MoteusDriver>(&driver)) {
    return encode_stop(*moteus, protocol::MoteusQuery::state, frame);
  }
  const auto* odrive = std::get_if<OdriveNode>(&driver);
  return protocol::encode_set_state(odrive->node, static_cast<std::uint32_t>(protocol::OdriveState::idle),
                                    frame);
}

JointBusStatus CanRobot::write(const JointCommands& commands) noexcept {
  if (!std::all_of(commands.begin(), commands.end(), finite)) return JointBusStatus::refused;
  std::array<CanFrame, kJoints> frames;
  bool all_see = true;
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    all_see = all_see && !blind(joint);
    const EncodeStatus status = encode(joint, commands[joint], frames[joint]);
    if (!usable(status)) return JointBusStatus::refused;
    if (status == EncodeStatus::saturated) ++saturated_;
  }
  const JointBusStatus status = send(frames);
  ask_drivers();
  return status == JointBusStatus::ok && !all_see ? JointBusStatus::incomplete : status;
}

/// An ODrive tells supply and temperatures only when it is asked to, or told to by its own configuration.
void CanRobot::ask_drivers() noexcept {
  const std::uint64_t turn = writes_++ % kQuestionsEvery;
  const auto joint = static_cast<std::size_t>(turn / 2);
  if (joint >= kJoints) return;
  const auto* odrive = std::get_if<OdriveNode>(&wiring_.joints[joint].driver);
  if (odrive == nullptr) return;
  CanFrame frame;
  const auto what = turn % 2 == 0 ? protocol::OdriveCommand::supply : protocol::OdriveCommand::temperature;
  if (protocol::encode_request(odrive->node, what, frame) != EncodeStatus::ok) return;
  static_cast<void>(buses_[wiring_.joints[joint].bus]->send(std::span(&frame, 1)));  // asked again soon
}

JointBusStatus CanRobot::disable() noexcept {
  std::array<CanFrame, kJoints> frames;
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    if (!usable(encode_disable(joint, frames[joint])))
      return JointBusStatus::refused;  // only with invalid wiring
  }
  return send(frames);
}

JointBusStatus CanRobot::send(const std::array<CanFrame, kJoints>& frames) noexcept {
  JointBusStatus status = bus_status();
  for (std::size_t bus = 0; bus < bus_count_; ++bus) {
    std::array<CanFrame, kJoints> batch;
    std::size_t count = 0;
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      if (wiring_.joints[joint].bus == bus) batch[count++] = frames[joint];
    }
    if (count == 0) continue;
    const SendResult result = buses_[bus]->send(std::span(batch).first(count));
    if (result.status == BusStatus::disconnected) status = JointBusStatus::disconnected;
    if (result.sent < count && status == JointBusStatus::ok) status = JointBusStatus::incomplete;
  }
  return status;
}

BaseSensorStatus CanRobot::read_base(BaseReading& reading) noexcept {
  reading = base_;
  return base_fresh_ ? BaseSensorStatus::ok : BaseSensorStatus::stale;
}

EmergencyStopState CanRobot::read_emergency_stop(std::int64_t now_ns) noexcept {
  if (!has_emergency_stop_) return EmergencyStopState::absent;
  const bool recent =
      emergency_stop_time_ns_ != 0 && now_ns - emergency_stop_time_ns_ <= wiring_.emergency_stop_timeout_ns;
  if (!recent) return EmergencyStopState::unknown;
  return emergency_stop_released_ ? EmergencyStopState::released : EmergencyStopState::pressed;
}

}  // namespace stilt::hal
