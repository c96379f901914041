#include "hal/ak/ak_driver.h"

#include <cmath>

namespace stilt::hal::ak {
namespace {

/// Farther from the newest position than a joint gets from one report to the next: it counts otherwise.
constexpr double kFar_rad = 0.1;
constexpr double kAgree_rad = 1.01 * kAkStatusStep_rad;

void take_status(const AkDriver& driver, const AkStatus& status, DriverReading& reading) noexcept {
  const bool refined = std::abs(reading.fine_position_rad - status.position_rad) <= kAgree_rad;
  reading.has_motion = true;
  reading.position_rad = refined ? reading.fine_position_rad : status.position_rad;
  reading.fine_position_rad = DriverReading::kNotReported;
  reading.velocity_rad_s = status.velocity_rad_s;
  reading.driver_temperature_C = status.driver_temperature_C;
  if (driver.torque_constant_Nm_A != 0) reading.torque_Nm = driver.torque_constant_Nm_A * status.current_A;
  reading.set_state(status.disabled ? DriverState::idle : DriverState::unknown, status.fault, status.code);
}

void take_position(double position_rad, DriverReading& reading) noexcept {
  if (!(std::abs(position_rad - reading.position_rad) <= kFar_rad)) return;
  reading.has_motion = std::isnan(reading.fine_position_rad);
  if (reading.has_motion) reading.position_rad = position_rad;
  reading.fine_position_rad = position_rad;
}

}  // namespace

/// A driver that starts has lost its command, and maybe its zero.
DecodeStatus take_frame(const AkDriver& driver, const CanFrame& frame, DriverReading& reading) noexcept {
  if (is_start(driver, frame)) {
    reading.has_started = true;
    reading.set_state(DriverState::idle, DriverFault::none, 0);
    return DecodeStatus::ok;
  }
  AkStatus status;
  const DecodeStatus of_status = decode_status(driver, frame, status);
  if (of_status == DecodeStatus::ok) take_status(driver, status, reading);
  if (of_status != DecodeStatus::not_addressed) return of_status;
  double position_rad = 0;
  const DecodeStatus of_position = decode_position(driver, frame, position_rad);
  if (of_position == DecodeStatus::ok && driver.position_frames) take_position(position_rad, reading);
  return of_position;
}

EncodeStatus command_frame(const AkDriver& driver, const DriverCommand& command, CanFrame& frame) noexcept {
  return encode_command(driver,
                        {.position_rad = command.position_rad,
                         .velocity_rad_s = command.velocity_rad_s,
                         .kp_Nm_rad = command.kp_Nm_rad,
                         .kd_Nms_rad = command.kd_Nms_rad,
                         .torque_Nm = command.torque_Nm},
                        frame);
}

}  // namespace stilt::hal::ak
