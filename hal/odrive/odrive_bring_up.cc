#include "hal/odrive/odrive_bring_up.h"

#include <bit>
#include <cmath>

#include "hal/can/bytes.h"
#include "hal/odrive/odrive_version.h"

namespace stilt::hal::odrive {
namespace {

using bring_up::BringUp;
using bring_up::Failure;
using bring_up::Setting;
using bring_up::Stage;

constexpr double kWatchdogTolerance_s = 1e-6;
/// Other times than 0 that somebody may have stored; a whole number would be far below.
constexpr float kLeastStored_s = 1e-4F, kMostStored_s = 1e4F;
/// While listening, for 50 ms: with the documented rates 50, 5 and 10.
constexpr unsigned kLeastEstimates = 40;
constexpr unsigned kLeastHeartbeats = 2;
constexpr unsigned kLeastTorques = 5;

bool is_of(std::uint8_t node, const CanFrame& frame) noexcept {
  OdriveCommand command{};
  return decode_command(node, frame, command) == DecodeStatus::ok && !frame.remote;
}

}  // namespace

BringUp::Ask OdriveBringUp::asked(EncodeStatus status, Ask kind) noexcept {
  if (status == EncodeStatus::ok) return kind;
  failure(Failure::invalid);
  return Ask::fail;
}

BringUp::Ask OdriveBringUp::ask(Stage stage, unsigned part, CanFrame& frame) noexcept {
  switch (stage) {
    case Stage::identify:
      if (part == 0) {  // disable it first, whatever it was doing
        listened_ = 0;
        written_ = silent_ = false;
        proved_ = !knows_endpoints();
        return asked(encode_set_state(node_, static_cast<std::uint32_t>(OdriveState::idle), frame),
                     Ask::send_only);
      }
      [[fallthrough]];
    case Stage::version:
      return asked(encode_request(node_, OdriveCommand::version, frame), Ask::wait_for_answer);
    case Stage::scaling:
      if (part == 0) return ask_torque_mode(frame);
      if (checked_endpoint(part) == 0) return Ask::skip;
      return asked(encode_parameter_request(node_, {false, checked_endpoint(part), 0, 4}, frame),
                   Ask::wait_for_answer);
    case Stage::watchdog_write:
    case Stage::watchdog_read:
      return ask_watchdog(stage, part, frame);
    case Stage::home:
      if (part == 0) {
        return asked(encode_request(node_, OdriveCommand::encoder_estimates, frame), Ask::wait_for_answer);
      }
      return ask_rates();
    case Stage::enable:
      return ask_enable(part, frame);
    case Stage::ready:
    case Stage::failed:
      break;
  }
  return Ask::skip;
}

BringUp::Ask OdriveBringUp::ask_torque_mode(CanFrame& frame) noexcept {
  return asked(
      encode_set_controller_mode(node_, OdriveControlMode::torque, OdriveInputMode::passthrough, frame),
      Ask::send_only);
}

BringUp::Ask OdriveBringUp::ask_watchdog(Stage stage, unsigned part, CanFrame& frame) noexcept {
  if (!knows_endpoints()) {
    if (options().accept_missing_watchdog) return Ask::skip;
    failure(Failure::no_watchdog, {.setting = Setting::odrive_watchdog_endpoints});
    return Ask::fail;
  }
  constexpr unsigned kParameters = 2;  // both stages read them first
  const bool writes = stage == Stage::watchdog_write;
  const bool write = writes && part >= kParameters;
  if (part >= (writes ? 2 * kParameters : kParameters)) return Ask::skip;
  written_ = written_ || write;
  const OdriveParameter timeout{write, endpoints_.watchdog_timeout,
                                std::bit_cast<std::uint32_t>(static_cast<float>(options().watchdog_s)), 4};
  const OdriveParameter enable{write, endpoints_.enable_watchdog, 1, 1};
  return asked(encode_parameter_request(node_, part % kParameters == 0 ? timeout : enable, frame),
               write ? Ask::send_only : Ask::wait_for_answer);
}

bool OdriveBringUp::undo(unsigned part, CanFrame& frame) noexcept {
  if (!written_ || proved_ || part > 2) return false;
  if (part == 0) {
    return encode_set_state(node_, static_cast<std::uint32_t>(OdriveState::idle), frame) == EncodeStatus::ok;
  }
  const OdriveParameter timeout{true, endpoints_.watchdog_timeout, old_bits_[0], 4};
  const OdriveParameter enable{true, endpoints_.enable_watchdog, old_bits_[1], 1};
  return encode_parameter_request(node_, part == 1 ? timeout : enable, frame) == EncodeStatus::ok;
}

/// The robot is read from estimates, a driver that has disarmed shows in its heartbeat, and one that gives no
/// torque in its torques.
BringUp::Ask OdriveBringUp::ask_rates() noexcept {
  const bool encoder = estimates_ < kLeastEstimates;
  const bool heartbeat = heartbeats_ < kLeastHeartbeats;
  const bool enough = !encoder && !heartbeat && torques_ >= kLeastTorques;
  if (listened_ > 0 && enough) return Ask::skip;
  if (listened_ < options().tries) {  // a computer that was late has seen too few, too
    ++listened_;
    estimates_ = heartbeats_ = torques_ = 0;
    return Ask::listen;
  }
  failure(Failure::wrong_setting, {.setting = encoder     ? Setting::odrive_encoder_rate
                                              : heartbeat ? Setting::odrive_heartbeat_rate
                                                          : Setting::odrive_torque_rate});
  return Ask::fail;
}

/// The watchdog has expired meanwhile: feed it, clear that, and enable. Nothing acknowledges the mode, so it
/// goes before each try.
BringUp::Ask OdriveBringUp::ask_enable(unsigned part, CanFrame& frame) noexcept {
  if (silent_) return ask_silence();
  if (part == 0) {
    mode_sent_ = false;
    return asked(encode_input_torque(node_, 0, frame), Ask::send_only);
  }
  if (part == 1) return asked(encode_clear_errors(node_, frame), Ask::send_only);
  mode_sent_ = !mode_sent_;
  if (mode_sent_) return ask_torque_mode(frame);
  return asked(encode_set_state(node_, static_cast<std::uint32_t>(OdriveState::closed_loop), frame),
               Ask::wait_for_answer);
}

/// Longer than the watchdog and the heartbeats' period.
BringUp::Ask OdriveBringUp::ask_silence() noexcept {
  const double longest = 1 + std::ceil(options().watchdog_s / (1e-9 * kListen_ns));
  if (silences_++ < longest) return Ask::listen;
  failure(Failure::wrong_watchdog, {.setting = Setting::odrive_other_endpoints});
  return Ask::fail;
}

BringUp::Verdict OdriveBringUp::judge(Stage stage, unsigned part, const CanFrame& frame) noexcept {
  switch (stage) {
    case Stage::identify:
      return is_of(node_, frame) ? Verdict::next_stage : Verdict::ignore;
    case Stage::version:
      return judge_version(frame);
    case Stage::watchdog_read:
      return judge_watchdog(part, frame);
    case Stage::home:
      return judge_home(part, frame);
    case Stage::enable:
      return judge_enable(frame);
    case Stage::scaling:
      return judge_limits(part, frame);
    case Stage::watchdog_write:
      return judge_old_value(part, frame);
    case Stage::ready:
    case Stage::failed:
      break;
  }
  return Verdict::ignore;
}

/// Firmware 0.5 reports by itself and does not have the request.
BringUp::Verdict OdriveBringUp::judge_version(const CanFrame& frame) noexcept {
  OdriveVersion version;
  if (decode(node_, frame, version) != DecodeStatus::ok) {
    if (is_of(node_, frame)) suspect(Failure::old_version, {});
    return Verdict::ignore;
  }
  const std::uint32_t firmware = firmware_number(version);
  const std::uint32_t hardware = hardware_number(version);
  if (firmware < options().minimum_version) {
    failure(Failure::old_version);
  } else if (endpoints_.any() && firmware != endpoints_.firmware_version) {
    failure(Failure::wrong_version, {.setting = Setting::odrive_firmware_version,
                                     .version = firmware,
                                     .wanted_version = endpoints_.firmware_version});
  } else if (endpoints_.any() && hardware != endpoints_.hardware_version) {
    failure(Failure::wrong_version, {.setting = Setting::odrive_hardware_version,
                                     .version = hardware,
                                     .wanted_version = endpoints_.hardware_version});
  } else {
    return Verdict::next_stage;
  }
  return Verdict::fail;
}

/// What is to be a time and a switch must be such before it is written. An answer without a value is of an
/// endpoint that does not exist.
BringUp::Verdict OdriveBringUp::judge_old_value(unsigned part, const CanFrame& frame) noexcept {
  OdriveParameter answer;
  const std::uint16_t endpoint = part == 0 ? endpoints_.watchdog_timeout : endpoints_.enable_watchdog;
  if (decode_parameter_answer(node_, frame, answer) != DecodeStatus::ok || answer.endpoint != endpoint) {
    return Verdict::ignore;
  }
  if (answer.value_bytes == 0) {
    suspect(Failure::wrong_watchdog, {.setting = Setting::odrive_other_endpoints});
    return Verdict::ignore;
  }
  const float time_s = std::bit_cast<float>(answer.bits);
  const bool plausible =
      part == 0
          ? answer.value_bytes == 4 && (time_s == 0 || (time_s >= kLeastStored_s && time_s <= kMostStored_s))
          : answer.bits <= 1;
  if (!plausible) {
    failure(Failure::wrong_watchdog, {.setting = Setting::odrive_other_endpoints});
    return Verdict::fail;
  }
  old_bits_[part] = answer.bits;
  return Verdict::next_part;
}

/// Firmware from 0.6.11 also confirms writes, without a value: those are not the answer. The answer of before
/// the write may come twice.
BringUp::Verdict OdriveBringUp::judge_watchdog(unsigned part, const CanFrame& frame) noexcept {
  OdriveParameter answer;
  const std::uint16_t endpoint = part == 0 ? endpoints_.watchdog_timeout : endpoints_.enable_watchdog;
  if (decode_parameter_answer(node_, frame, answer) != DecodeStatus::ok || answer.endpoint != endpoint ||
      answer.value_bytes == 0) {
    return Verdict::ignore;
  }
  const bool right =
      part == 0 ? answer.value_bytes == 4 && std::abs(static_cast<double>(std::bit_cast<float>(answer.bits)) -
                                                      options().watchdog_s) <= kWatchdogTolerance_s
                : (answer.bits & 0xff) == 1;
  if (right) return part == 0 ? Verdict::next_part : Verdict::next_stage;
  if (answer.bits == old_bits_[part]) {
    suspect(Failure::wrong_watchdog, {.setting = Setting::odrive_other_endpoints});
    return Verdict::not_yet;
  }
  failure(Failure::wrong_watchdog, {.setting = Setting::odrive_other_endpoints});
  return Verdict::fail;
}

/// Of those that are known, in parts 1 and 2 of the stage; 0: no more.
std::uint16_t OdriveBringUp::checked_endpoint(unsigned part) const noexcept {
  const std::uint16_t first = endpoints_.torque_mode_limit;
  const std::uint16_t second = endpoints_.velocity_limit;
  if (part == 1) return first != 0 ? first : second;
  return part == 2 && first != 0 ? second : 0;
}

/// In torque mode both limit the torque, and an axis faster than 1.2 vel_limit disarms in any mode.
BringUp::Verdict OdriveBringUp::judge_limits(unsigned part, const CanFrame& frame) noexcept {
  OdriveParameter answer;
  if (decode_parameter_answer(node_, frame, answer) != DecodeStatus::ok ||
      answer.endpoint != checked_endpoint(part) || answer.value_bytes == 0) {
    return Verdict::ignore;
  }
  if (answer.endpoint == endpoints_.torque_mode_limit) {
    if ((answer.bits & 0xff) == 0) return Verdict::next_part;
    failure(Failure::wrong_setting, {.setting = Setting::odrive_torque_mode_limit});
    return Verdict::fail;
  }
  const double limit_rad_s = static_cast<double>(std::bit_cast<float>(answer.bits)) * kRadiansPerRevolution;
  if (limit_rad_s >= options().maximum_speed_rad_s) return Verdict::next_part;
  failure(Failure::wrong_setting, {.setting = Setting::odrive_velocity_limit});
  return Verdict::fail;
}

BringUp::Verdict OdriveBringUp::judge_home(unsigned part, const CanFrame& frame) noexcept {
  OdriveEstimates estimates;
  OdriveHeartbeat heartbeat;
  const bool estimated = decode(node_, frame, estimates) == DecodeStatus::ok;
  if (part == 0) {
    if (!estimated) return Verdict::ignore;
    return check_home(estimates.position_rad) ? Verdict::next_part : Verdict::fail;
  }
  if (estimated) ++estimates_;
  if (decode(node_, frame, heartbeat) == DecodeStatus::ok) ++heartbeats_;
  if (is_torques(node_, frame)) ++torques_;
  return Verdict::ignore;
}

/// A heartbeat may be older than what cleared its errors.
BringUp::Verdict OdriveBringUp::judge_enable(const CanFrame& frame) noexcept {
  OdriveHeartbeat heartbeat;
  if (decode(node_, frame, heartbeat) != DecodeStatus::ok) return Verdict::ignore;
  const bool enabled = heartbeat.state == static_cast<std::uint8_t>(OdriveState::closed_loop);
  if (silent_ && enabled) return Verdict::ignore;
  if (silent_ && (heartbeat.errors & kOdriveWatchdogExpired) != 0) {
    silent_ = false;
    proved_ = true;
    return Verdict::first_part;
  }
  if (heartbeat.errors != 0) {
    silent_ = false;
    suspect(Failure::driver_fault, {odrive_fault(heartbeat.errors), heartbeat.errors, Setting::none});
    return Verdict::first_part;
  }
  if (!enabled) return Verdict::not_yet;
  if (proved_) return Verdict::next_stage;
  silent_ = true;
  silences_ = 0;
  return Verdict::next_part;
}

bool OdriveBringUp::keep_alive(CanFrame& frame) noexcept {
  return !silent_ && encode_input_torque(node_, 0, frame) == EncodeStatus::ok;
}

}  // namespace stilt::hal::odrive
