#include "hal/mit/mit_driver.h"

#include "hal/mit/damiao_registers.h"

namespace stilt::hal::mit {

/// Under the identifier of its replies a Damiao also answers for its registers, while it is off. As a state
/// such an answer would be the lower end of position and velocity at once.
DecodeStatus take_frame(const MitDriver& driver, const CanFrame& frame, DriverReading& reading) noexcept {
  DamiaoRegisterMessage about_register;
  if (driver.layout == ReplyLayout::damiao &&
      decode_register_answer(driver, frame, about_register) == DecodeStatus::ok) {
    return DecodeStatus::ok;
  }
  MitReply reply;
  const DecodeStatus status = decode_reply(driver, frame, reply);
  if (status != DecodeStatus::ok) return status;
  reading.has_motion = true;
  reading.position_rad = reply.position_rad;
  reading.velocity_rad_s = reply.velocity_rad_s;
  reading.torque_Nm = reply.torque_Nm;
  reading.driver_temperature_C = reply.driver_temperature_C;
  reading.motor_temperature_C = reply.motor_temperature_C;
  reading.supply_V = reply.supply_V;
  const DriverState known = reply.enabled ? DriverState::enabled : DriverState::idle;
  reading.set_state(reply.reports_enabled ? known : DriverState::unknown, reply.fault, reply.fault_code);
  return status;
}

EncodeStatus command_frame(const MitDriver& driver, const DriverCommand& command, CanFrame& frame) noexcept {
  const MitCommand law{command.position_rad, command.velocity_rad_s, command.kp_Nm_rad, command.kd_Nms_rad,
                       command.torque_Nm};
  return encode_command(driver, law, frame);
}

EncodeStatus disable_frame(const MitDriver& driver, CanFrame& frame) noexcept {
  frame = special_frame(driver, MitSpecial::leave);
  return EncodeStatus::ok;
}

std::optional<CanFrame> fault_reset_frame(const MitDriver& driver) noexcept {
  if (driver.layout != ReplyLayout::damiao) return std::nullopt;
  return special_frame(driver, MitSpecial::clear_error);
}

}  // namespace stilt::hal::mit
