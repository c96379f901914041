#include "hal/ak/ak_emulator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stilt::hal::ak {
namespace {

constexpr double kLeast_C = -20, kMost_C = 127;

void push(EncodeStatus status, const CanFrame& frame, FrameSink& replies) noexcept {
  if (status == EncodeStatus::ok || status == EncodeStatus::saturated) replies.push(frame);
}

}  // namespace

double AkEmulator::torque_Nm() const noexcept {
  if (!gives_torque() || disabled_ || fault_code_ != 0) return 0;
  const AkCommand command = command_of(driver_, codes_, behaviour_.whole_scale);
  const double torque_Nm = command.kp_Nm_rad * (command.position_rad - sensed().position_rad) +
                           command.kd_Nms_rad * (command.velocity_rad_s - sensed().velocity_rad_s) +
                           command.torque_Nm;
  return std::clamp(torque_Nm, -driver_.torque_Nm, driver_.torque_Nm);
}

double AkEmulator::current_A() const noexcept {
  const double constant_Nm_A = driver_.torque_constant_Nm_A != 0 ? driver_.torque_constant_Nm_A : 1;
  const double current_A = torque_Nm() / constant_Nm_A;
  if (!behaviour_.current_of_driving) return current_A;
  return std::copysign(current_A, torque_Nm() * sensed().velocity_rad_s);
}

double AkEmulator::reported_rad() const noexcept {
  constexpr double kTurn_rad = 2 * std::numbers::pi;
  const double position_rad = sensed().position_rad;
  return settings_.single_turn ? position_rad - kTurn_rad * std::floor(position_rad / kTurn_rad)
                               : position_rad;
}

void AkEmulator::raise(DriverFault fault) noexcept {
  fault_code_ = ak_code(fault);
  fault_since_ns_ = 0;
}

void AkEmulator::power_cycle() noexcept {
  codes_ = kLimp;
  fault_code_ = 0;
  disabled_ = confirms_disable_ = false;
  starts_ = true;
  set_zero_rad(kept_zero_rad_);
  if (!behaviour_.keeps_turns) lose_turns(2 * std::numbers::pi / driver_.gear_ratio);
}

void AkEmulator::take_origin(const CanFrame& frame) noexcept {
  if (frame.length != 1) return;
  count_from(0);
  if (frame.data[0] == 1) kept_zero_rad_ = zero_rad();
}

void AkEmulator::take_feedback(const CanFrame& frame) noexcept {
  if (frame.length != 8) return;
  settings_.position_frames = (frame.data[6] & 0x80) != 0;
  settings_.single_turn = (frame.data[6] & 0x40) != 0;
}

void AkEmulator::take(std::int64_t now_ns, const CanFrame& frame, FrameSink& /*replies*/) noexcept {
  if (!powered() || !frame.extended || frame.remote || frame.error || frame.fd) return;
  if (decode_codes(driver_.id, frame, codes_) == DecodeStatus::ok) {
    disabled_ = false;
    commanded_ns_ = now_ns;
  } else if (frame.id == ak_id(AkMode::set_origin, driver_.id)) {
    take_origin(frame);
  } else if (frame.id == ak_id(AkMode::set_feedback, driver_.id)) {
    take_feedback(frame);
  } else if (frame.id == ak_id(AkMode::disable, driver_.id) && behaviour_.knows_disable) {
    disabled_ = confirms_disable_ = true;
  }
}

void AkEmulator::report(FrameSink& replies) noexcept {
  AkStatus status;
  status.position_rad = reported_rad();
  status.velocity_rad_s = sensed().velocity_rad_s;
  status.current_A = current_A();
  status.driver_temperature_C = std::clamp(motor.temperature_C, kLeast_C, kMost_C);
  status.code = fault_code_;
  status.disabled = confirms_disable_;
  confirms_disable_ = false;
  CanFrame of_status, of_position;
  const EncodeStatus encoded = encode_status(driver_, status, of_status);
  const std::uint8_t length = behaviour_.long_position_frame ? 8 : 4;
  const EncodeStatus placed = encode_position(driver_, reported_rad(), length, of_position);
  if (!settings_.position_frames) return push(encoded, of_status, replies);
  if (behaviour_.position_first) push(placed, of_position, replies);
  push(encoded, of_status, replies);
  if (!behaviour_.position_first) push(placed, of_position, replies);
}

/// Without power it keeps nothing but its flash.
void AkEmulator::elapse(std::int64_t now_ns, FrameSink& replies) noexcept {
  if (!powered()) return power_cycle();
  if (starts_ && behaviour_.sends_start) replies.push(start_frame(driver_));
  starts_ = false;
  if (fault_code_ != 0 && fault_since_ns_ == 0) fault_since_ns_ = now_ns;
  if (!behaviour_.keeps_fault && now_ns - fault_since_ns_ >= behaviour_.fault_ns) fault_code_ = 0;
  const std::int64_t timeout_ns = settings_.command_timeout_ns;
  if (timeout_ns > 0 && now_ns - commanded_ns_ > timeout_ns) codes_ = kLimp;
  if (now_ns < next_report_ns_) return;
  const auto period_ns = std::llround(1e9 / settings_.status_rate_hz * (1 + behaviour_.clock_error));
  const bool was_silent = now_ns - next_report_ns_ > period_ns;
  next_report_ns_ = (was_silent ? now_ns : next_report_ns_) + period_ns;
  report(replies);
}

}  // namespace stilt::hal::ak
