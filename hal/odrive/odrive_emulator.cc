#include "hal/odrive/odrive_emulator.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "hal/can/bytes.h"

namespace stilt::hal::odrive {
namespace {

constexpr std::uint32_t kTooFast = 0x00008000;      // velocity limit violation
constexpr double kVelocityTolerance = 1.2;          // controller.config.vel_limit_tolerance
constexpr double kVelocityGain_Nm_s_rev = 1.0 / 6;  // controller.config.vel_gain
constexpr double kPositionGain_1_s = 20;            // controller.config.pos_gain

std::uint32_t bit_of(DriverFault fault) noexcept {
  switch (fault) {
    case DriverFault::over_voltage:
      return 0x100;
    case DriverFault::under_voltage:
      return 0x200;
    case DriverFault::over_current:
      return 0x400;
    case DriverFault::motor_over_temperature:
      return 0x2000;
    case DriverFault::driver_over_temperature:
      return 0x4000;
    case DriverFault::encoder:
      return 0x8;
    case DriverFault::gate_driver:
      return 0x20;
    case DriverFault::lost_communication:
      return kOdriveWatchdogExpired;
    case DriverFault::emergency_stop:
      return 0x02000000;
    default:
      return 0x2;
  }
}

template <class Message>
void push(std::uint8_t node, const Message& message, FrameSink& replies) noexcept {
  CanFrame frame;
  const EncodeStatus status = encode(node, message, frame);
  if (status == EncodeStatus::ok || status == EncodeStatus::saturated) replies.push(frame);
}

/// Of firmware 0.5: one error for all that is wrong with the motor, and flags instead of a result.
CanFrame old_heartbeat(std::uint8_t node, std::uint32_t errors, std::uint32_t state) noexcept {
  constexpr std::uint32_t kMotorFailed = 0x40;
  CanFrame frame = classic_frame(
      static_cast<std::uint32_t>(node) << 5 | static_cast<std::uint32_t>(OdriveCommand::heartbeat), 8);
  store_little(std::span(frame.data).first(4), errors == 0 ? 0 : kMotorFailed);
  frame.data[4] = static_cast<std::uint8_t>(state);
  frame.data[5] = errors == 0 ? 0 : 1;  // of the motor; then of encoder and controller
  return frame;
}

/// Two numbers that are 0. Firmware 0.5 has its estimates without an encoder under the identifier of the
/// temperatures of 0.6.
CanFrame old_answer(std::uint8_t node, OdriveCommand what) noexcept {
  return classic_frame(static_cast<std::uint32_t>(node) << 5 | static_cast<std::uint32_t>(what), 8);
}

}  // namespace

bool OdriveEmulator::enabled() const noexcept {
  return state_ == static_cast<std::uint32_t>(OdriveState::closed_loop);
}

/// In position control the torque that is asked for is added to that of the loop. In torque mode with its
/// limit |torque| falls with the velocity, to nothing at the velocity limit.
double OdriveEmulator::torque_Nm() const noexcept {
  if (!enabled() || !gives_torque()) return 0;
  if (control_mode_ != static_cast<std::uint32_t>(OdriveControlMode::torque)) {
    const double wanted_rad_s = kPositionGain_1_s * (held_rad_ - sensed().position_rad);
    const double off_rev_s = (wanted_rad_s - sensed().velocity_rad_s) / kRadiansPerRevolution;
    return torque_Nm_ + kVelocityGain_Nm_s_rev * off_rev_s;
  }
  if (!settings_.torque_mode_limit) return torque_Nm_;
  const double velocity_rev_s = sensed().velocity_rad_s / kRadiansPerRevolution;
  const double limit_rev_s = settings_.velocity_limit_rev_s;
  return std::clamp(torque_Nm_, (-limit_rev_s - velocity_rev_s) * kVelocityGain_Nm_s_rev,
                    (limit_rev_s - velocity_rev_s) * kVelocityGain_Nm_s_rev);
}

void OdriveEmulator::disarm(std::uint32_t error) noexcept {
  errors_ |= error;
  state_ = static_cast<std::uint32_t>(OdriveState::idle);
  enabled_from_ns_ = 0;
  torque_Nm_ = 0;
}

void OdriveEmulator::raise(DriverFault fault) noexcept { disarm(bit_of(fault)); }

void OdriveEmulator::power_cycle() noexcept {
  disarm(0);
  errors_ = 0;
  watchdog_enabled_ = false;
  watchdog_s_ = 0;
  control_mode_ = kPositionControl;
  count_from(0);
}

void OdriveEmulator::answer_request(OdriveCommand what, FrameSink& replies) const noexcept {
  if (!settings_.answers_version) {  // firmware 0.5
    if (what == OdriveCommand::heartbeat) return replies.push(old_heartbeat(node_, errors_, state_));
    if (what == OdriveCommand::temperature) return replies.push(old_answer(node_, what));
    if (what == OdriveCommand::version || what == OdriveCommand::torques) return;
  }
  switch (what) {
    case OdriveCommand::version:
      push(node_, version_, replies);
      break;
    case OdriveCommand::heartbeat:
      push(node_, OdriveHeartbeat{errors_, static_cast<std::uint8_t>(state_), 0, false}, replies);
      break;
    case OdriveCommand::errors:
      push(node_, OdriveErrors{errors_, errors_}, replies);
      break;
    case OdriveCommand::encoder_estimates:
      push(node_, OdriveEstimates{sensed().position_rad, sensed().velocity_rad_s}, replies);
      break;
    case OdriveCommand::torques:
      push(node_, OdriveTorques{torque_Nm_, torque_Nm()}, replies);
      break;
    case OdriveCommand::temperature:
      push(node_, OdriveTemperatures{motor.temperature_C, motor.temperature_C}, replies);
      break;
    case OdriveCommand::supply:
      push(node_, OdriveSupply{motor.supply_V, 0}, replies);
      break;
    default:
      break;
  }
}

void OdriveEmulator::take_parameter(const OdriveParameter& request, FrameSink& replies) noexcept {
  const bool timeout = request.endpoint == endpoints_.watchdog_timeout;
  const bool enable = request.endpoint == endpoints_.enable_watchdog;
  const bool limit = request.endpoint == endpoints_.torque_mode_limit;
  const bool velocity = request.endpoint == endpoints_.velocity_limit;
  OdriveParameter answer{false, request.endpoint, 0, 0};
  if (request.write) {
    if (timeout) watchdog_s_ = std::bit_cast<float>(request.bits);
    if (enable) watchdog_enabled_ = request.bits != 0;
  } else if (timeout) {
    answer.bits = std::bit_cast<std::uint32_t>(watchdog_s_);
    answer.value_bytes = 4;
  } else if (enable) {
    answer.bits = watchdog_enabled_ ? 1 : 0;
    answer.value_bytes = 1;
  } else if (limit) {
    answer.bits = settings_.torque_mode_limit ? 1 : 0;
    answer.value_bytes = 1;
  } else if (velocity) {
    answer.bits = std::bit_cast<std::uint32_t>(static_cast<float>(settings_.velocity_limit_rev_s));
    answer.value_bytes = 4;
  }
  CanFrame frame;
  if (encode_parameter_answer(node_, answer, frame) == EncodeStatus::ok) replies.push(frame);
}

void OdriveEmulator::take_state(std::int64_t now_ns, const CanFrame& frame) noexcept {
  std::uint32_t wanted = 0;
  if (decode_set_state(node_, frame, wanted) != DecodeStatus::ok) return;
  if (!settings_.setpoints_alone_feed) fed_ns_ = now_ns;
  const bool closed_loop = wanted == static_cast<std::uint32_t>(OdriveState::closed_loop);
  if (closed_loop && enabled()) return;
  state_ = static_cast<std::uint32_t>(OdriveState::idle);
  torque_Nm_ = 0;
  if (!closed_loop) {
    enabled_from_ns_ = 0;
  } else if (errors_ == 0 && enabled_from_ns_ == 0) {
    enabled_from_ns_ = now_ns + settings_.enable_ns;
  }
}

void OdriveEmulator::take_command(std::int64_t now_ns, OdriveCommand command, const CanFrame& frame,
                                  FrameSink& replies) noexcept {
  OdriveParameter parameter;
  std::uint32_t input_mode = 0;
  switch (command) {
    case OdriveCommand::parameter_request:
      if (decode_parameter_request(node_, frame, parameter) == DecodeStatus::ok) {
        take_parameter(parameter, replies);
      }
      break;
    case OdriveCommand::set_state:
      take_state(now_ns, frame);
      break;
    case OdriveCommand::set_input_torque:
      if (decode_input_torque(node_, frame, torque_Nm_) == DecodeStatus::ok) fed_ns_ = now_ns;
      break;
    case OdriveCommand::set_controller_mode:
      static_cast<void>(decode_set_controller_mode(node_, frame, control_mode_, input_mode));
      break;
    case OdriveCommand::clear_errors:
      errors_ = 0;
      if (!settings_.setpoints_alone_feed) fed_ns_ = now_ns;
      break;
    case OdriveCommand::emergency_stop:
      raise(DriverFault::emergency_stop);
      break;
    default:
      break;
  }
}

void OdriveEmulator::take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept {
  OdriveCommand command{};
  if (!powered() || decode_command(node_, frame, command) != DecodeStatus::ok) return;
  elapse(now_ns, replies);
  if (frame.remote) {
    const bool ignored = (command == OdriveCommand::heartbeat && !settings_.answers_heartbeat_request) ||
                         (command == OdriveCommand::version && !settings_.answers_version);
    if (!ignored) answer_request(command, replies);
  } else {
    take_command(now_ns, command, frame, replies);
  }
}

/// Whether a message is sent now, by the driver's own clock, which begins with the first message and anew
/// after silence.
bool OdriveEmulator::due(std::int64_t now_ns, std::int64_t period_ns, std::int64_t& next_ns) const noexcept {
  if (now_ns < next_ns) return false;
  const auto own_ns = std::llround(static_cast<double>(period_ns) * (1 + settings_.clock_error));
  const bool begins = next_ns == 0 || now_ns - next_ns > own_ns;
  next_ns = (begins ? now_ns : next_ns) + own_ns;
  return true;
}

void OdriveEmulator::elapse(std::int64_t now_ns, FrameSink& replies) noexcept {
  if (!powered()) return;
  const double silence_s = static_cast<double>(now_ns - fed_ns_) * 1e-9;
  const bool counts = watchdog_enabled_ && (enabled() || settings_.expires_in_idle);
  if (counts && silence_s > static_cast<double>(watchdog_s_)) disarm(kOdriveWatchdogExpired);
  const double fastest_rad_s = kVelocityTolerance * settings_.velocity_limit_rev_s * kRadiansPerRevolution;
  if (enabled() && std::abs(sensed().velocity_rad_s) > fastest_rad_s) disarm(kTooFast);
  if (enabled_from_ns_ != 0 && now_ns >= enabled_from_ns_) {
    state_ = static_cast<std::uint32_t>(OdriveState::closed_loop);
    enabled_from_ns_ = 0;
    held_rad_ = sensed().position_rad;
  }
  if (due(now_ns, settings_.heartbeat_period_ns, next_heartbeat_ns_))
    answer_request(OdriveCommand::heartbeat, replies);
  if (due(now_ns, settings_.estimates_period_ns, next_estimates_ns_))
    answer_request(OdriveCommand::encoder_estimates, replies);
  if (settings_.torques_period_ns > 0 && due(now_ns, settings_.torques_period_ns, next_torques_ns_))
    answer_request(OdriveCommand::torques, replies);
}

}  // namespace stilt::hal::odrive
