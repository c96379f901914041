#include "hal/moteus/moteus_bring_up.h"

#include <cmath>

namespace stilt::hal::moteus {
namespace {

using bring_up::BringUp;
using bring_up::Failure;
using bring_up::Stage;

constexpr double kWatchdogTolerance_s = 0.0005;  // half a step of the register

bool is_mode(const MoteusReply& reply, MoteusMode mode) noexcept {
  return reply.has_mode && reply.mode == static_cast<std::uint8_t>(mode);
}

}  // namespace

BringUp::Ask MoteusBringUp::ask(Stage stage, unsigned /*part*/, CanFrame& frame) noexcept {
  EncodeStatus status = EncodeStatus::invalid;
  switch (stage) {
    case Stage::identify:
      status = encode_stop(driver_, MoteusQuery::identity, frame);
      break;
    case Stage::scaling:
      return Ask::skip;  // scales are fixed by the register map version
    case Stage::version:
    case Stage::watchdog_read:
      status = encode_query(driver_, MoteusQuery::identity, frame);
      break;
    case Stage::watchdog_write:
      status = encode_watchdog(driver_, options().watchdog_s, frame);
      break;
    case Stage::home:
      status = encode_query(driver_, MoteusQuery::state, frame);
      break;
    case Stage::enable:
    case Stage::ready:
    case Stage::failed:
      status = keep_alive(frame) ? EncodeStatus::ok : EncodeStatus::invalid;
      break;
  }
  if (status == EncodeStatus::ok) return Ask::wait_for_answer;
  failure(Failure::invalid);
  return Ask::fail;
}

BringUp::Verdict MoteusBringUp::wrong(Failure what, DriverFault fault) noexcept {
  failure(what, fault);
  return Verdict::fail;
}

BringUp::Verdict MoteusBringUp::judge_home(const MoteusReply& reply) noexcept {
  const bool one_turn = rotor_referenced_ && options().encoder_period_rad > 0;
  if (!output_referenced_ && !one_turn) return wrong(Failure::not_home);
  if (!std::isfinite(reply.position_rad)) return wrong(Failure::not_home);
  return check_home(reply.position_rad) ? Verdict::next_stage : Verdict::fail;
}

BringUp::Verdict MoteusBringUp::judge(Stage stage, unsigned /*part*/, const CanFrame& frame) noexcept {
  MoteusReply reply;
  if (decode_reply(driver_, frame, reply) != DecodeStatus::ok || !reply.has_mode) return Verdict::ignore;
  if (is_mode(reply, MoteusMode::fault)) return wrong(Failure::driver_fault, moteus_fault(reply.fault_code));
  switch (stage) {
    case Stage::identify:
      return is_mode(reply, MoteusMode::stopped) ? Verdict::next_stage : Verdict::not_yet;
    case Stage::version:
      if (!reply.has_firmware_version) return Verdict::ignore;
      if (reply.firmware_version < options().minimum_version) return wrong(Failure::old_version);
      output_referenced_ = reply.home == static_cast<std::uint8_t>(MoteusHome::output);
      rotor_referenced_ = reply.home == static_cast<std::uint8_t>(MoteusHome::rotor);
      return Verdict::next_stage;
    case Stage::watchdog_write:
      return Verdict::next_stage;
    case Stage::watchdog_read:
      if (!(std::abs(reply.watchdog_s - options().watchdog_s) <= kWatchdogTolerance_s)) {
        return wrong(std::isnan(reply.watchdog_s) ? Failure::no_watchdog : Failure::wrong_watchdog);
      }
      return Verdict::next_stage;
    case Stage::home:
      return judge_home(reply);
    case Stage::enable:
      return is_mode(reply, MoteusMode::position) ? Verdict::next_stage : Verdict::not_yet;
    case Stage::scaling:
    case Stage::ready:
    case Stage::failed:
      break;
  }
  return Verdict::ignore;
}

bool MoteusBringUp::keep_alive(CanFrame& frame) noexcept {
  MoteusCommand limp;
  limp.maximum_torque_Nm = 0;
  limp.watchdog_s = options().watchdog_s;
  return encode_command(driver_, limp, frame) == EncodeStatus::ok;
}

}  // namespace stilt::hal::moteus
