#include "hal/mit/mit_bring_up.h"

#include <array>
#include <bit>
#include <cmath>

namespace stilt::hal::mit {
namespace {

using bring_up::BringUp;
using bring_up::Failure;
using bring_up::Setting;
using bring_up::Stage;

constexpr std::uint32_t kMitControlMode = 1;
constexpr double kRangeTolerance = 1e-4;  // relative; the registers are floats

constexpr std::array<DamiaoRegister, 2> kIdentity{DamiaoRegister::command_id, DamiaoRegister::control_mode};
constexpr std::array<DamiaoRegister, 3> kScaling{
    DamiaoRegister::position_range, DamiaoRegister::velocity_range, DamiaoRegister::torque_range};
constexpr std::array<Setting, 3> kRanges{Setting::damiao_position_range, Setting::damiao_velocity_range,
                                         Setting::damiao_torque_range};

/// The register a stage asks for in a part.
DamiaoRegister asked_register(Stage stage, unsigned part) noexcept {
  switch (stage) {
    case Stage::identify:
      return kIdentity[part];
    case Stage::scaling:
      return kScaling[part];
    case Stage::watchdog_write:
    case Stage::watchdog_read:
      return DamiaoRegister::timeout;
    default:
      return DamiaoRegister::software_version;
  }
}

bool symmetric(const Range& range, double maximum) noexcept {
  return std::abs(range.maximum - maximum) <= kRangeTolerance * maximum &&
         std::abs(range.minimum + maximum) <= kRangeTolerance * maximum;
}

std::uint32_t timeout_units(double watchdog_s) noexcept {
  return static_cast<std::uint32_t>(std::lround(watchdog_s / kDamiaoTimeoutUnit_s));
}

}  // namespace

BringUp::Ask MitBringUp::ask_register(DamiaoRegister number, CanFrame& frame) const noexcept {
  const DamiaoRegisterMessage message{.number = static_cast<std::uint8_t>(number)};
  return encode_register_request(driver_, message, frame) == EncodeStatus::ok ? Ask::wait_for_answer
                                                                              : Ask::fail;
}

BringUp::Ask MitBringUp::limp(CanFrame& frame) noexcept {
  if (keep_alive(frame)) return Ask::send_only;
  failure(Failure::invalid);
  return Ask::fail;
}

BringUp::Ask MitBringUp::ask_identity(unsigned part, CanFrame& frame) noexcept {
  if (has_registers()) return ask_register(asked_register(Stage::identify, part), frame);
  if (part == 0) return limp(frame);
  frame = off_or_on();
  return Ask::wait_for_answer;
}

/// In turn: an AK that is off may not answer.
CanFrame MitBringUp::off_or_on() const noexcept {
  const bool off = tries() % 2 == 0 || driver_.layout == ReplyLayout::damiao;
  return special_frame(driver_, off ? MitSpecial::leave : MitSpecial::enter);
}

BringUp::Ask MitBringUp::ask_watchdog(Stage stage, unsigned part, CanFrame& frame) noexcept {
  if (!has_registers()) {
    if (options().accept_missing_watchdog) return Ask::skip;
    failure(Failure::no_watchdog, {.setting = Setting::accepted_watchdog});
    return Ask::fail;
  }
  if (stage == Stage::watchdog_read) return ask_register(DamiaoRegister::timeout, frame);
  if (part > 0) return Ask::skip;  // written; the next stage reads it back
  const DamiaoRegisterMessage message{true, static_cast<std::uint8_t>(DamiaoRegister::timeout),
                                      timeout_units(options().watchdog_s)};
  return encode_register_request(driver_, message, frame) == EncodeStatus::ok ? Ask::send_only : Ask::fail;
}

/// Its timeout may have expired meanwhile: a Damiao is cleared first.
BringUp::Ask MitBringUp::ask_enable(unsigned part, CanFrame& frame) noexcept {
  if (part == 0) return limp(frame);
  if (part == 1 && has_registers()) {
    frame = special_frame(driver_, MitSpecial::clear_error);
    return Ask::send_only;
  }
  frame = special_frame(driver_, MitSpecial::enter);
  return Ask::wait_for_answer;
}

BringUp::Ask MitBringUp::ask(Stage stage, unsigned part, CanFrame& frame) noexcept {
  if (!valid(driver_)) {
    failure(Failure::invalid);
    return Ask::fail;
  }
  switch (stage) {
    case Stage::identify:
      return ask_identity(part, frame);
    case Stage::version:
    case Stage::scaling:
      return has_registers() ? ask_register(asked_register(stage, part), frame) : Ask::skip;
    case Stage::watchdog_write:
    case Stage::watchdog_read:
      return ask_watchdog(stage, part, frame);
    case Stage::home:
      frame = off_or_on();
      return Ask::wait_for_answer;
    case Stage::enable:
      return ask_enable(part, frame);
    case Stage::ready:
    case Stage::failed:
      break;
  }
  return Ask::skip;
}

/// Frames that only a driver sends whose settings are not the configured ones.
void MitBringUp::suspect_settings(const CanFrame& frame) noexcept {
  MitDriver factory = driver_;
  factory.reply_id = kDamiaoFactoryReplyId;
  DamiaoRegisterMessage answer;
  if (has_registers() && driver_.reply_id != kDamiaoFactoryReplyId &&
      decode_register_answer(factory, frame, answer) == DecodeStatus::ok) {
    suspect(Failure::wrong_setting, {.setting = Setting::damiao_reply_id});
  }
  if (driver_.layout != ReplyLayout::ak) return;
  if (frame.extended && frame.id == ak_servo_status_id(driver_)) {
    suspect(Failure::wrong_setting, {.setting = Setting::ak_control_mode});
  }
  if (replies_with(driver_.command_id, frame)) {
    suspect(Failure::silent, {.setting = Setting::ak_reply_id_own});
  }
  if (replies_with(kAkZeroReplyId, frame)) suspect(Failure::silent, {.setting = Setting::ak_reply_id_zero});
}

/// A reply of this driver, with an identifier that is not the configured one.
bool MitBringUp::replies_with(std::uint16_t id, const CanFrame& frame) const noexcept {
  MitDriver sender = driver_;
  sender.reply_id = id;
  MitReply reply;
  return id != driver_.reply_id && decode_reply(sender, frame, reply) == DecodeStatus::ok;
}

BringUp::Verdict MitBringUp::judge(Stage stage, unsigned part, const CanFrame& frame) noexcept {
  if (stage == Stage::identify) suspect_settings(frame);
  const bool about_state = stage == Stage::home || stage == Stage::enable || !has_registers();
  return about_state ? judge_state(stage, frame) : judge_register(stage, part, frame);
}

BringUp::Verdict MitBringUp::judge_state(Stage stage, const CanFrame& frame) noexcept {
  MitReply reply;
  if (decode_reply(driver_, frame, reply) != DecodeStatus::ok) return Verdict::ignore;
  const bool expired = has_registers() && reply.fault == DriverFault::lost_communication;
  if (reply.fault != DriverFault::none && !(stage == Stage::home && expired)) {
    const Blame blame{reply.fault, reply.fault_code, Setting::none};
    if (stage == Stage::enable && has_registers()) {  // cleared again with the next try
      suspect(Failure::driver_fault, blame);
      return Verdict::first_part;
    }
    failure(Failure::driver_fault, blame);
    return Verdict::fail;
  }
  if (stage == Stage::home && !check_home(reply.position_rad)) return Verdict::fail;
  if (stage == Stage::enable && reply.reports_enabled && !reply.enabled) return Verdict::not_yet;
  return Verdict::next_stage;
}

BringUp::Verdict MitBringUp::judge_range(unsigned part, double maximum) noexcept {
  const std::array<const Range*, 3> command{&driver_.position_rad, &driver_.velocity_rad_s,
                                            &driver_.torque_Nm};
  const std::array<const Range*, 3> reply{&driver_.reply_position_rad, &driver_.reply_velocity_rad_s,
                                          &driver_.reply_torque_Nm};
  if (!symmetric(*command[part], maximum) || !symmetric(*reply[part], maximum)) {
    failure(Failure::wrong_scaling, {.setting = kRanges[part]});
    return Verdict::fail;
  }
  return part + 1 < kScaling.size() ? Verdict::next_part : Verdict::next_stage;
}

BringUp::Verdict MitBringUp::judge_register(Stage stage, unsigned part, const CanFrame& frame) noexcept {
  DamiaoRegisterMessage message;
  if (decode_register_answer(driver_, frame, message) != DecodeStatus::ok || message.write ||
      message.number != static_cast<std::uint8_t>(asked_register(stage, part))) {
    return Verdict::ignore;
  }
  Failure wrong = Failure::none;
  Setting setting = Setting::none;
  switch (stage) {
    case Stage::identify:
      if (message.bits != (part == 0 ? driver_.command_id : kMitControlMode)) wrong = Failure::wrong_identity;
      if (part > 0) setting = Setting::damiao_control_mode;
      if (wrong == Failure::none && part + 1 < kIdentity.size()) return Verdict::next_part;
      break;
    case Stage::version:
      if (message.bits < options().minimum_version) wrong = Failure::old_version;
      break;
    case Stage::scaling:
      return judge_range(part, std::bit_cast<float>(message.bits));
    case Stage::watchdog_read:
      if (message.bits != timeout_units(options().watchdog_s)) wrong = Failure::wrong_watchdog;
      setting = Setting::damiao_timeout;
      break;
    default:
      return Verdict::ignore;
  }
  if (wrong == Failure::none) return Verdict::next_stage;
  failure(wrong, {.setting = setting});
  return Verdict::fail;
}

bool MitBringUp::keep_alive(CanFrame& frame) noexcept {
  return encode_command(driver_, {}, frame) == EncodeStatus::ok;
}

}  // namespace stilt::hal::mit
