#include "hal/mit/mit_emulator.h"

#include <algorithm>
#include <bit>

namespace stilt::hal::mit {
namespace {

constexpr std::uint8_t kDamiaoLostCommunication = 0xd;

std::uint8_t damiao_code(DriverFault fault) noexcept {
  switch (fault) {
    case DriverFault::over_voltage:
      return 0x8;
    case DriverFault::under_voltage:
      return 0x9;
    case DriverFault::over_current:
      return 0xa;
    case DriverFault::driver_over_temperature:
      return 0xb;
    case DriverFault::motor_over_temperature:
      return 0xc;
    case DriverFault::lost_communication:
      return kDamiaoLostCommunication;
    case DriverFault::encoder:
      return 0x5;
    default:
      return 0xe;
  }
}

std::uint8_t ak_code(DriverFault fault) noexcept {
  switch (fault) {
    case DriverFault::motor_over_temperature:
      return 1;
    case DriverFault::over_current:
      return 2;
    case DriverFault::over_voltage:
      return 3;
    case DriverFault::under_voltage:
      return 4;
    case DriverFault::encoder:
      return 5;
    case DriverFault::driver_over_temperature:
      return 6;
    default:
      return 7;
  }
}

}  // namespace

MitDriver MitEmulator::as_set(MitDriver driver, const MitSettings& settings) noexcept {
  if (driver.layout != ReplyLayout::damiao) return driver;
  driver.reply_id = settings.reply_id;
  const auto set = [](Range& command, Range& reply, double range) {
    if (command.maximum != range) command = reply = {-range, range};
  };
  set(driver.position_rad, driver.reply_position_rad, settings.position_range_rad);
  set(driver.velocity_rad_s, driver.reply_velocity_rad_s, settings.velocity_range_rad_s);
  set(driver.torque_Nm, driver.reply_torque_Nm, settings.torque_range_Nm);
  return driver;
}

void MitEmulator::power_cycle() noexcept {
  enabled_ = false;
  enabled_from_ns_ = 0;
  fault_code_ = 0;
  timeout_units_ = 0;
  command_ = {};
  if (driver_.layout != ReplyLayout::damiao) lose_turns(behaviour_.rotor_turn_rad);
}

void MitEmulator::raise(DriverFault fault) noexcept {
  enabled_ = false;
  enabled_from_ns_ = 0;
  if (driver_.layout == ReplyLayout::damiao) fault_code_ = damiao_code(fault);
  if (driver_.layout == ReplyLayout::ak) fault_code_ = ak_code(fault);
}

double MitEmulator::torque_Nm() const noexcept {
  if (!enabled_ || !gives_torque()) return 0;
  const double torque_Nm = command_.kp_Nm_rad * (command_.position_rad - sensed().position_rad) +
                           command_.kd_Nms_rad * (command_.velocity_rad_s - sensed().velocity_rad_s) +
                           command_.torque_Nm;
  return std::clamp(torque_Nm, driver_.torque_Nm.minimum, driver_.torque_Nm.maximum);
}

void MitEmulator::reply(FrameSink& replies) const noexcept {
  MitReply state;
  state.position_rad = sensed().position_rad;
  state.velocity_rad_s = sensed().velocity_rad_s;
  state.torque_Nm = torque_Nm();
  if (reports_supply()) state.supply_V = motor.supply_V;
  state.driver_temperature_C = state.motor_temperature_C = motor.temperature_C;
  state.fault_code = fault_code_;
  if (driver_.layout == ReplyLayout::damiao && fault_code_ == 0) state.fault_code = enabled_ ? 1 : 0;
  CanFrame frame;
  const EncodeStatus status = encode_reply(driver_, state, frame);
  if (status == EncodeStatus::ok || status == EncodeStatus::saturated) replies.push(frame);
}

void MitEmulator::take_special(std::int64_t now_ns, MitSpecial special) noexcept {
  const bool keeps_commands = driver_.layout == ReplyLayout::mini_cheetah;
  switch (special) {
    case MitSpecial::enter:
      if (fault_code_ == 0 && enabled_from_ns_ == 0) enabled_from_ns_ = now_ns + behaviour_.enable_ns;
      break;
    case MitSpecial::leave:
      if (enabled_) command_ = {};
      if (driver_.layout == ReplyLayout::ak && !behaviour_.keeps_fault) fault_code_ = 0;
      enabled_ = false;
      enabled_from_ns_ = 0;
      break;
    case MitSpecial::clear_error:
      fault_code_ = 0;
      break;
    case MitSpecial::set_zero:
      if (!enabled_) count_from(0);
      break;
  }
  if (!keeps_commands) command_ = {};
}

std::uint32_t MitEmulator::register_bits(std::uint8_t number) const noexcept {
  const auto bits = [](double value) { return std::bit_cast<std::uint32_t>(static_cast<float>(value)); };
  switch (static_cast<DamiaoRegister>(number)) {
    case DamiaoRegister::reply_id:
      return driver_.reply_id;
    case DamiaoRegister::command_id:
      return driver_.command_id;
    case DamiaoRegister::timeout:
      return timeout_units_;
    case DamiaoRegister::control_mode:
      return settings_.control_mode;
    case DamiaoRegister::software_version:
      return software_version_;
    case DamiaoRegister::position_range:
      return bits(driver_.position_rad.maximum);
    case DamiaoRegister::velocity_range:
      return bits(driver_.velocity_rad_s.maximum);
    case DamiaoRegister::torque_range:
      return bits(reported_torque_Nm_ > 0 ? reported_torque_Nm_ : driver_.torque_Nm.maximum);
  }
  return 0;
}

void MitEmulator::take_register(DamiaoRegisterMessage message, FrameSink& replies) noexcept {
  if (message.write) {
    if (message.number == static_cast<std::uint8_t>(DamiaoRegister::timeout)) timeout_units_ = message.bits;
  } else {
    message.bits = register_bits(message.number);
  }
  CanFrame frame;
  if (encode_register_answer(driver_, message, frame) == EncodeStatus::ok) replies.push(frame);
}

void MitEmulator::take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept {
  if (!powered() || in_servo_mode()) return;
  DamiaoRegisterMessage message;
  if (driver_.layout == ReplyLayout::damiao &&
      decode_register_request(driver_, frame, message) == DecodeStatus::ok) {
    take_register(message, replies);
    return;
  }
  elapse(now_ns, replies);
  MitSpecial special{};
  const bool is_special = decode_special(driver_, frame, special) == DecodeStatus::ok;
  MitCommand command;
  if (!is_special && decode_command(driver_, frame, command) != DecodeStatus::ok) return;
  const bool before = driver_.layout == ReplyLayout::mini_cheetah || behaviour_.answers_before_frame;
  const bool was_enabled = enabled_;
  if (before) reply(replies);
  last_command_ns_ = now_ns;
  if (is_special) {
    take_special(now_ns, special);
    elapse(now_ns, replies);
  } else {
    command_ = command;
    uncommanded_ns_ = 0;
  }
  if (!before && (enabled_ || was_enabled || !behaviour_.silent_while_off)) reply(replies);
}

/// Position, speed, current, temperature and fault by themselves, 50 times per second.
void MitEmulator::send_servo_status(std::int64_t now_ns, FrameSink& replies) noexcept {
  constexpr std::int64_t kPeriod_ns = 20'000'000;
  if (now_ns < next_status_ns_) return;
  next_status_ns_ = now_ns + kPeriod_ns;
  CanFrame frame = classic_frame(ak_servo_status_id(driver_), 8);
  frame.extended = true;
  frame.data[6] = static_cast<std::uint8_t>(motor.temperature_C);
  frame.data[7] = fault_code_;
  replies.push(frame);
}

void MitEmulator::elapse(std::int64_t now_ns, FrameSink& replies) noexcept {
  if (powered() && in_servo_mode()) send_servo_status(now_ns, replies);
  if (enabled_from_ns_ != 0 && now_ns >= enabled_from_ns_) enabled_ = fault_code_ == 0;
  if (enabled_) uncommanded_ns_ += now_ns - elapsed_ns_;
  elapsed_ns_ = now_ns;
  const std::int64_t allowed_ns =
      driver_.layout == ReplyLayout::mini_cheetah ? behaviour_.command_timeout_ns : 0;
  if (allowed_ns > 0 && uncommanded_ns_ >= allowed_ns) command_ = {};
  const double silence_s = static_cast<double>(now_ns - last_command_ns_) * 1e-9;
  const bool watched = enabled_ || behaviour_.timeout_while_off;
  if (watched && timeout_units_ > 0 && silence_s > timeout_units_ * kDamiaoTimeoutUnit_s) {
    enabled_ = false;
    enabled_from_ns_ = 0;
    fault_code_ = kDamiaoLostCommunication;
  }
}

}  // namespace stilt::hal::mit
