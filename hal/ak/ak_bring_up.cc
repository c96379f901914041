#include "hal/ak/ak_bring_up.h"

#include <cmath>

namespace stilt::hal::ak {
namespace {

using bring_up::BringUp;
using bring_up::Failure;
using bring_up::Setting;
using bring_up::Stage;

constexpr unsigned kLongest = 20;  // times of listening: 1 s, also for a driver that reports once per second
constexpr unsigned kLimpCommands = 3;  // one may be lost, and it would go on with what it held
constexpr double kLeastShare = 0.8;
/// Between a status and a position frame of the same report, or of the one before.
constexpr double kAgree_rad = 0.1;

}  // namespace

BringUp::Ask AkBringUp::limp(CanFrame& frame) noexcept {
  listened_ = 0;
  received_ = false;
  fault_ = {};
  if (encode_limp(driver_, frame) == EncodeStatus::ok) return Ask::send_only;
  failure(Failure::invalid);
  return Ask::fail;
}

/// Until judge() is satisfied, for a second.
BringUp::Ask AkBringUp::await_frames(Failure otherwise) noexcept {
  if (listened_++ < kLongest) return Ask::listen;
  failure(otherwise, otherwise == Failure::driver_fault ? fault_ : Blame{});
  return Ask::fail;
}

unsigned AkBringUp::least_reports() const noexcept {
  return static_cast<unsigned>(kLeastShare * 1e-9 * static_cast<double>(kListen_ns) * driver_.status_rate_hz);
}

/// Missed reports count from the rate of the configuration, so it must be the driver's.
BringUp::Ask AkBringUp::ask_rates() noexcept {
  const bool seldom = statuses_ < least_reports();
  const bool coarse = driver_.position_frames && positions_ < least_reports();
  if (listened_ > 0 && !seldom && !coarse) return Ask::skip;
  if (listened_ < options().tries) {  // a computer that was late has seen too few, too
    ++listened_;
    statuses_ = positions_ = 0;
    return Ask::listen;
  }
  failure(Failure::wrong_setting,
          {.setting = seldom ? Setting::ak_v3_status_rate : Setting::ak_v3_position_frames});
  return Ask::fail;
}

BringUp::Ask AkBringUp::ask(Stage stage, unsigned part, CanFrame& frame) noexcept {
  switch (stage) {
    case Stage::identify:
      return part < kLimpCommands ? limp(frame) : await_frames(Failure::silent);
    case Stage::watchdog_write:
      if (options().accept_missing_watchdog) return Ask::skip;
      failure(Failure::no_watchdog, {.setting = Setting::accepted_watchdog});
      return Ask::fail;
    case Stage::home:
      return part == 0 ? await_frames(Failure::silent) : ask_rates();
    case Stage::enable:
      if (part == 0) return limp(frame);
      if (fault_.fault != DriverFault::none) return await_frames(Failure::driver_fault);
      return await_frames(received_ ? Failure::rejected : Failure::silent);
    case Stage::version:
    case Stage::scaling:
    case Stage::watchdog_read:
    case Stage::ready:
    case Stage::failed:
      break;
  }
  return Ask::skip;
}

BringUp::Verdict AkBringUp::judge(Stage stage, unsigned part, const CanFrame& frame) noexcept {
  if (stage == Stage::home) return judge_home(part, frame);
  if (stage == Stage::enable) return judge_enable(frame);
  AkStatus status;
  if (decode_status(driver_, frame, status) != DecodeStatus::ok) return Verdict::ignore;
  listened_ = 0;
  return Verdict::next_stage;
}

BringUp::Verdict AkBringUp::judge_home(unsigned part, const CanFrame& frame) noexcept {
  AkStatus status;
  double position_rad = 0;
  if (decode_status(driver_, frame, status) == DecodeStatus::ok) {
    status_rad_ = status.position_rad;
    ++statuses_;
    if (part > 0) return Verdict::ignore;
    listened_ = 0;
    return check_home(status.position_rad) ? Verdict::next_part : Verdict::fail;
  }
  if (decode_position(driver_, frame, position_rad) == DecodeStatus::ok &&
      std::abs(position_rad - status_rad_) <= kAgree_rad) {
    ++positions_;
  }
  return Verdict::ignore;
}

/// Also of a driver that was ready: one with a fault, or that has started again, is to begin anew.
BringUp::Verdict AkBringUp::judge_enable(const CanFrame& frame) noexcept {
  AkStatus status;
  if (is_start(driver_, frame)) return Verdict::not_yet;
  if (decode_status(driver_, frame, status) != DecodeStatus::ok) return Verdict::ignore;
  received_ = true;
  fault_ = {status.fault, status.code, Setting::none};
  if (status.fault != DriverFault::none || status.disabled) return Verdict::not_yet;
  return Verdict::next_stage;
}

}  // namespace stilt::hal::ak
