#include "hal/odrive/odrive_emulator.h"

#include <bit>

namespace stilt::hal::odrive {
namespace {

constexpr std::uint32_t kWatchdogExpired = 0x01000000;

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
      return kWatchdogExpired;
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

}  // namespace

bool OdriveEmulator::enabled() const noexcept {
  return state_ == static_cast<std::uint32_t>(OdriveState::closed_loop);
}

void OdriveEmulator::disarm(std::uint32_t error) noexcept {
  errors_ |= error;
  state_ = static_cast<std::uint32_t>(OdriveState::idle);
  torque_Nm_ = 0;
}

void OdriveEmulator::raise(DriverFault fault) noexcept { disarm(bit_of(fault)); }

void OdriveEmulator::power_cycle() noexcept {
  disarm(0);
  errors_ = 0;
  watchdog_enabled_ = false;
  watchdog_s_ = 0;
}

void OdriveEmulator::answer_request(OdriveCommand what, FrameSink& replies) const noexcept {
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
  }
  CanFrame frame;
  if (encode_parameter_answer(node_, answer, frame) == EncodeStatus::ok) replies.push(frame);
}

void OdriveEmulator::take_command(std::int64_t now_ns, OdriveCommand command, const CanFrame& frame,
                                  FrameSink& replies) noexcept {
  OdriveParameter parameter;
  switch (command) {
    case OdriveCommand::parameter_request:
      if (decode_parameter_request(node_, frame, parameter) == DecodeStatus::ok) {
        take_parameter(parameter, replies);
      }
      break;
    case OdriveCommand::set_state:
      if (decode_set_state(node_, frame, state_) == DecodeStatus::ok) {
        if (errors_ != 0) state_ = static_cast<std::uint32_t>(OdriveState::idle);
        torque_Nm_ = 0;
        fed_ns_ = now_ns;
      }
      break;
    case OdriveCommand::set_input_torque:
      if (decode_input_torque(node_, frame, torque_Nm_) == DecodeStatus::ok) fed_ns_ = now_ns;
      break;
    case OdriveCommand::clear_errors:
      errors_ = 0;
      fed_ns_ = now_ns;
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
  if (frame.remote) {
    answer_request(command, replies);
  } else {
    take_command(now_ns, command, frame, replies);
  }
}

void OdriveEmulator::elapse(std::int64_t now_ns, FrameSink& replies) noexcept {
  if (!powered()) return;
  const double silence_s = static_cast<double>(now_ns - fed_ns_) * 1e-9;
  if (watchdog_enabled_ && silence_s > static_cast<double>(watchdog_s_)) disarm(kWatchdogExpired);
  if (now_ns >= next_estimates_ns_) {
    answer_request(OdriveCommand::encoder_estimates, replies);
    next_estimates_ns_ = now_ns + kEstimatesPeriod_ns;
  }
  if (now_ns >= next_heartbeat_ns_) {
    answer_request(OdriveCommand::heartbeat, replies);
    next_heartbeat_ns_ = now_ns + kHeartbeatPeriod_ns;
  }
}

}  // namespace stilt::hal::odrive
