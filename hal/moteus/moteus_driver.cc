#include "hal/moteus/moteus_driver.h"

#include <cmath>

namespace stilt::hal::moteus {
namespace {

/// In every other mode it does not follow our commands: on its way, or driven by somebody else.
DriverState state_of(std::uint8_t mode) noexcept {
  const auto is = static_cast<MoteusMode>(mode);
  const bool follows = is == MoteusMode::position || is == MoteusMode::zero_velocity;
  return follows ? DriverState::enabled : DriverState::idle;
}

DriverFault fault_of(const MoteusReply& reply) noexcept {
  if (reply.mode == static_cast<std::uint8_t>(MoteusMode::timeout)) return DriverFault::lost_communication;
  if (reply.mode != static_cast<std::uint8_t>(MoteusMode::fault)) return DriverFault::none;
  const DriverFault fault = moteus_fault(reply.fault_code);
  return fault == DriverFault::none ? DriverFault::other : fault;  // in fault mode, whatever the code
}

}  // namespace

DecodeStatus take_frame(const MoteusDriver& driver, const CanFrame& frame, DriverReading& reading) noexcept {
  MoteusReply reply;
  const DecodeStatus status = decode_reply(driver, frame, reply);
  if (status != DecodeStatus::ok) return status;
  if (std::isfinite(reply.position_rad) && std::isfinite(reply.velocity_rad_s)) {
    reading.has_motion = true;
    reading.position_rad = reply.position_rad;
    reading.velocity_rad_s = reply.velocity_rad_s;
    if (!std::isnan(reply.torque_Nm)) reading.torque_Nm = reply.torque_Nm;
  }
  if (reply.has_fault) {
    reading.driver_temperature_C = reply.temperature_C;
    reading.supply_V = reply.voltage_V;
  }
  if (!std::isnan(reply.motor_temperature_C)) reading.motor_temperature_C = reply.motor_temperature_C;
  if (reply.has_mode) reading.set_state(state_of(reply.mode), fault_of(reply), reply.fault_code);
  if (driver.extra_encoder >= 0) {
    const auto encoder = static_cast<std::size_t>(driver.extra_encoder);
    reading.encoder_position_rad = reply.encoder_position_rad[encoder];
    reading.encoder_velocity_rad_s = reply.encoder_velocity_rad_s[encoder];
  }
  return status;
}

/// Without kp the position stays unset: it has no part in the torque, and may be beyond what fits a frame.
EncodeStatus command_frame(const MoteusDriver& driver, const DriverCommand& command,
                           CanFrame& frame) noexcept {
  const MoteusCommand law{command.kp_Nm_rad == 0 ? DriverReading::kNotReported : command.position_rad,
                          command.velocity_rad_s,
                          command.torque_Nm,
                          command.kp_Nm_rad,
                          command.kd_Nms_rad,
                          command.torque_limit_Nm,
                          command.watchdog_s};
  return encode_command(driver, law, frame,
                        command.asks_motor_temperature ? MoteusQuery::state_and_motor : MoteusQuery::state);
}

EncodeStatus disable_frame(const MoteusDriver& driver, CanFrame& frame) noexcept {
  return encode_stop(driver, MoteusQuery::state, frame);
}

}  // namespace stilt::hal::moteus
