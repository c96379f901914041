#include "hal/odrive/odrive_driver.h"

namespace stilt::hal::odrive {
namespace {

/// Decodes the frame as Message and, when it is one, hands it to `take`. A driver that has no value yet sends
/// NaN: that is no news, and no malformed frame.
template <class Message, class Take>
DecodeStatus decode_and(std::uint8_t node, const CanFrame& frame, const Take& take) noexcept {
  Message message;
  const DecodeStatus status = decode(node, frame, message);
  if (status == DecodeStatus::ok) take(message);
  return status == DecodeStatus::not_finite ? DecodeStatus::ok : status;
}

}  // namespace

DecodeStatus take_frame(const OdriveDriver& driver, const CanFrame& frame, DriverReading& reading) noexcept {
  OdriveCommand command{};
  if (decode_command(driver.node, frame, command) != DecodeStatus::ok || frame.remote) {
    return DecodeStatus::not_addressed;
  }
  switch (command) {
    case OdriveCommand::encoder_estimates:
      return decode_and<OdriveEstimates>(driver.node, frame, [&](const OdriveEstimates& estimates) {
        reading.has_motion = true;
        reading.position_rad = estimates.position_rad;
        reading.velocity_rad_s = estimates.velocity_rad_s;
      });
    case OdriveCommand::torques:
      return decode_and<OdriveTorques>(
          driver.node, frame, [&](const OdriveTorques& torques) { reading.torque_Nm = torques.estimate_Nm; });
    case OdriveCommand::heartbeat:
      return decode_and<OdriveHeartbeat>(driver.node, frame, [&](const OdriveHeartbeat& heartbeat) {
        const bool enabled = heartbeat.state == static_cast<std::uint8_t>(OdriveState::closed_loop);
        reading.set_state(enabled ? DriverState::enabled : DriverState::idle, odrive_fault(heartbeat.errors),
                          heartbeat.errors);
      });
    case OdriveCommand::temperature:
      return decode_and<OdriveTemperatures>(driver.node, frame, [&](const OdriveTemperatures& temperatures) {
        reading.driver_temperature_C = temperatures.driver_C;
        reading.motor_temperature_C = temperatures.motor_C;
      });
    case OdriveCommand::supply:
      return decode_and<OdriveSupply>(
          driver.node, frame, [&](const OdriveSupply& supply) { reading.supply_V = supply.voltage_V; });
    default:
      return DecodeStatus::ok;  // of this node, nothing we need
  }
}

EncodeStatus command_frame(const OdriveDriver& driver, const DriverCommand& command,
                           CanFrame& frame) noexcept {
  return encode_input_torque(driver.node, command.law_Nm, frame);
}

EncodeStatus disable_frame(const OdriveDriver& driver, CanFrame& frame) noexcept {
  return encode_set_state(driver.node, static_cast<std::uint32_t>(OdriveState::idle), frame);
}

std::optional<CanFrame> fault_reset_frame(const OdriveDriver& driver) noexcept {
  CanFrame frame;
  if (encode_clear_errors(driver.node, frame) != EncodeStatus::ok) return std::nullopt;
  return frame;
}

std::optional<CanFrame> question_frame(const OdriveDriver& driver, unsigned question) noexcept {
  CanFrame frame;
  const auto what = question % 2 == 0 ? OdriveCommand::supply : OdriveCommand::temperature;
  if (encode_request(driver.node, what, frame) != EncodeStatus::ok) return std::nullopt;
  return frame;
}

}  // namespace stilt::hal::odrive
