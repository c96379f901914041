#include "hal/moteus/moteus.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "hal/can/bytes.h"

namespace stilt::hal::moteus {
namespace {

constexpr std::uint32_t kReplyBit = 0x8000;
constexpr std::uint8_t kFirstLimitCode = 96;
constexpr double kWatchdogStep_s = 0.001;
constexpr double kNoLimit = -0.05;  // anything negative: one step of an acceleration in int8

void write_one(SubframeWriter& writer, MoteusRegister where, Resolution resolution, double value) noexcept {
  writer.values(SubframeKind::write, where, resolution, std::span(&value, 1));
}

void query(const MoteusDriver& driver, MoteusQuery what, SubframeWriter& writer) noexcept {
  if (what == MoteusQuery::identity) {
    writer.read(MoteusRegister::mode, Resolution::int8, 1);
    writer.read(MoteusRegister::home_state, Resolution::int8, 1);
    writer.read(MoteusRegister::fault, Resolution::int8, 1);
    writer.read(MoteusRegister::command_timeout, Resolution::int32, 1);
    writer.read(MoteusRegister::firmware_version, Resolution::int32, 2);
    return;
  }
  if (what == MoteusQuery::control) {
    writer.read(MoteusRegister::mode, Resolution::int8, 1);
    writer.read(MoteusRegister::fault, Resolution::int8, 1);
    writer.read(MoteusRegister::proportional, Resolution::int32, 3);
    writer.read(MoteusRegister::control_position, Resolution::int32, 1);
    writer.read(MoteusRegister::position_error, Resolution::int32, 2);
    return;
  }
  writer.read(MoteusRegister::mode, Resolution::int32, 4);  // to the torque: one subframe is the shortest
  writer.read(MoteusRegister::voltage, Resolution::int8, 3);
  if (what == MoteusQuery::state_and_motor)
    writer.read(MoteusRegister::motor_temperature, Resolution::int8, 1);
  if (driver.extra_encoder >= 0) {
    const auto first =
        static_cast<std::uint16_t>(MoteusRegister::encoder_0_position) + 2 * driver.extra_encoder;
    writer.read(static_cast<MoteusRegister>(first), Resolution::int32, 2);
  }
}

bool finite_or_nan(double value) noexcept { return !std::isinf(value); }

bool acceptable(const MoteusCommand& command) noexcept {
  return finite_or_nan(command.position_rad) && std::isfinite(command.velocity_rad_s) &&
         std::isfinite(command.torque_Nm) && std::isfinite(command.kp_Nm_rad) &&
         std::isfinite(command.kd_Nms_rad) && finite_or_nan(command.maximum_torque_Nm) &&
         std::isfinite(command.watchdog_s);
}

/// A gain of an angle in radians as a fraction of the driver's own. Gains below 0 or above the driver's
/// saturate, by half a step of the register or more. The driver's own gain may round to a bit more than 1.
double scale_of(double gain_rad, double gain_rev, bool& saturated) noexcept {
  const double wanted = gain_rad * kRadiansPerRevolution / gain_rev;
  const double limited = std::clamp(wanted, 0.0, 1.0);
  saturated = saturated || std::abs(limited - wanted) > 0.5 * kScaleStep;
  return limited;
}

double watchdog_register(double watchdog_s) noexcept { return std::max(watchdog_s, kWatchdogStep_s); }

std::uint32_t as_number(double value) noexcept {
  return std::isfinite(value) ? static_cast<std::uint32_t>(std::clamp(value, 0.0, 4294967295.0)) : 0;
}

void take_encoder(MoteusReply& reply, std::uint32_t offset, double value) noexcept {
  auto& field = offset % 2 == 0 ? reply.encoder_position_rad : reply.encoder_velocity_rad_s;
  field[offset / 2] = value * kRadiansPerRevolution;
}

/// One register of a reply. False when a plain number is not a number.
bool take(MoteusReply& reply, std::uint32_t register_number, double value) noexcept {
  constexpr auto kFirstEncoder = static_cast<std::uint32_t>(MoteusRegister::encoder_0_position);
  if (is_plain(register_number) && !std::isfinite(value)) return false;
  if (register_number >= kFirstEncoder && register_number < kFirstEncoder + 2 * kMoteusEncoders) {
    take_encoder(reply, register_number - kFirstEncoder, value);
    return true;
  }
  switch (static_cast<MoteusRegister>(register_number)) {
    case MoteusRegister::mode:
      reply.mode = static_cast<std::uint8_t>(as_number(value) & 0xff);
      reply.has_mode = true;
      break;
    case MoteusRegister::position:
      reply.position_rad = value * kRadiansPerRevolution;
      break;
    case MoteusRegister::velocity:
      reply.velocity_rad_s = value * kRadiansPerRevolution;
      break;
    case MoteusRegister::torque:
      reply.torque_Nm = value;
      break;
    case MoteusRegister::voltage:
      reply.voltage_V = value;
      break;
    case MoteusRegister::temperature:
      reply.temperature_C = value;
      break;
    case MoteusRegister::motor_temperature:
      reply.motor_temperature_C = value;
      break;
    case MoteusRegister::fault:
      reply.fault_code = static_cast<std::uint8_t>(as_number(value) & 0xff);
      reply.has_fault = true;
      break;
    case MoteusRegister::home_state:
      reply.home = static_cast<std::uint8_t>(as_number(value) & 0xff);
      reply.has_home = true;
      break;
    case MoteusRegister::firmware_version:
      reply.firmware_version = as_number(value);
      reply.has_firmware_version = true;
      break;
    case MoteusRegister::register_map_version:
      reply.register_map_version = as_number(value);
      reply.has_register_map_version = true;
      break;
    case MoteusRegister::command_timeout:
      reply.watchdog_s = value;
      break;
    case MoteusRegister::proportional:
      reply.proportional_Nm = value;
      break;
    case MoteusRegister::integral:
      reply.integral_Nm = value;
      break;
    case MoteusRegister::derivative:
      reply.derivative_Nm = value;
      break;
    case MoteusRegister::control_position:
      reply.control_position_rad = value * kRadiansPerRevolution;
      reply.has_control = true;
      break;
    case MoteusRegister::position_error:
      reply.position_error_rad = value * kRadiansPerRevolution;
      break;
    case MoteusRegister::velocity_error:
      reply.velocity_error_rad_s = value * kRadiansPerRevolution;
      break;
    default:
      break;  // a register that was not requested does no harm
  }
  return true;
}

}  // namespace

CanFrame frame_to(const MoteusDriver& driver) noexcept {
  CanFrame frame;
  frame.id = kReplyBit | static_cast<std::uint32_t>(driver.source) << 8 | driver.id;
  frame.extended = true;  // the reply bit is beyond the 11 bits of a standard identifier
  frame.fd = true;
  frame.bit_rate_switch = driver.bit_rate_switch;
  return frame;
}

bool is_reply_of(const MoteusDriver& driver, const CanFrame& frame) noexcept {
  const std::uint32_t expected = static_cast<std::uint32_t>(driver.id) << 8 | driver.source;
  return frame.id == expected && !frame.remote && !frame.error;
}

bool is_frame_to(const MoteusDriver& driver, const CanFrame& frame) noexcept {
  const std::uint32_t expected = static_cast<std::uint32_t>(driver.source) << 8 | driver.id;
  return (frame.id & ~kReplyBit) == expected && !frame.remote && !frame.error;
}

CanFrame answer_to(const MoteusDriver& driver, const CanFrame& frame) noexcept {
  CanFrame answer;
  answer.id = static_cast<std::uint32_t>(driver.id) << 8 | driver.source;
  answer.extended = answer.id > kMaximumStandardId;
  answer.fd = frame.fd;
  answer.bit_rate_switch = frame.bit_rate_switch;
  return answer;
}

bool valid(const MoteusDriver& driver) noexcept {
  return driver.id >= 1 && driver.id <= kMoteusMaximumId && driver.source <= kMoteusMaximumId &&
         driver.id != driver.source && std::isfinite(driver.kp_Nm_rev) && driver.kp_Nm_rev > 0 &&
         std::isfinite(driver.kd_Nm_s_rev) && driver.kd_Nm_s_rev > 0 && driver.extra_encoder >= -1 &&
         driver.extra_encoder < kMoteusEncoders;
}

DriverFault moteus_fault(std::uint8_t code) noexcept {
  if (code == 0 || code >= kFirstLimitCode) return DriverFault::none;
  switch (code) {
    case 33:
      return DriverFault::gate_driver;
    case 34:
      return DriverFault::over_voltage;
    case 35:
    case 42:
    case 43:
      return DriverFault::encoder;
    case 32:  // zero of the current sensors not found
    case 36:
    case 41:
    case 45:
    case 47:
    case 48:
      return DriverFault::configuration;
    case 38:
      return DriverFault::driver_over_temperature;
    case 39:
      return DriverFault::position_limit;
    case 40:
      return DriverFault::under_voltage;
    case 44:
      return DriverFault::gate_driver;
    case 49:  // servo.fault_position_error
      return DriverFault::position_limit;
    case 50:  // servo.fault_velocity_error
      return DriverFault::velocity_limit;
    default:
      return DriverFault::other;
  }
}

EncodeStatus encode_command(const MoteusDriver& driver, const MoteusCommand& command, CanFrame& frame,
                            MoteusQuery what) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  if (!acceptable(command)) return EncodeStatus::not_finite;
  bool saturated = command.watchdog_s < kWatchdogStep_s;
  const std::array<double, 6> registers{command.position_rad / kRadiansPerRevolution,
                                        command.velocity_rad_s / kRadiansPerRevolution,
                                        command.torque_Nm,
                                        scale_of(command.kp_Nm_rad, driver.kp_Nm_rev, saturated),
                                        scale_of(command.kd_Nms_rad, driver.kd_Nm_s_rev, saturated),
                                        command.maximum_torque_Nm};
  frame = frame_to(driver);
  SubframeWriter writer(frame);
  write_one(writer, MoteusRegister::mode, Resolution::int8, static_cast<double>(MoteusMode::position));
  writer.values(SubframeKind::write, MoteusRegister::command_position, Resolution::int16, registers);
  write_one(writer, MoteusRegister::command_timeout, Resolution::int16,
            watchdog_register(command.watchdog_s));
  write_one(writer, MoteusRegister::command_accel_limit, Resolution::int8, kNoLimit);
  query(driver, what, writer);
  const EncodeStatus status = writer.finish();
  return status == EncodeStatus::ok && saturated ? EncodeStatus::saturated : status;
}

EncodeStatus encode_stop(const MoteusDriver& driver, MoteusQuery what, CanFrame& frame) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  frame = frame_to(driver);
  SubframeWriter writer(frame);
  write_one(writer, MoteusRegister::mode, Resolution::int8, static_cast<double>(MoteusMode::stopped));
  query(driver, what, writer);
  return writer.finish();
}

EncodeStatus encode_query(const MoteusDriver& driver, MoteusQuery what, CanFrame& frame) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  frame = frame_to(driver);
  SubframeWriter writer(frame);
  query(driver, what, writer);
  return writer.finish();
}

EncodeStatus encode_watchdog(const MoteusDriver& driver, double watchdog_s, CanFrame& frame) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  if (!std::isfinite(watchdog_s)) return EncodeStatus::not_finite;
  frame = frame_to(driver);
  SubframeWriter writer(frame);
  write_one(writer, MoteusRegister::command_timeout, Resolution::int16, watchdog_register(watchdog_s));
  query(driver, MoteusQuery::identity, writer);
  const EncodeStatus status = writer.finish();
  return status == EncodeStatus::ok && watchdog_s < kWatchdogStep_s ? EncodeStatus::saturated : status;
}

DecodeStatus decode_reply(const MoteusDriver& driver, const CanFrame& frame, MoteusReply& reply) noexcept {
  if (!is_reply_of(driver, frame)) return DecodeStatus::not_addressed;
  MoteusReply decoded;
  SubframeReader reader(frame.payload());
  Subframe subframe;
  while (reader.next(subframe)) {
    if (subframe.kind == SubframeKind::write_error || subframe.kind == SubframeKind::read_error) {
      decoded.register_error = true;
      continue;
    }
    if (subframe.kind == SubframeKind::stream_out) continue;
    if (subframe.kind != SubframeKind::reply) return DecodeStatus::malformed;
    for (std::uint32_t i = 0; i < subframe.count; ++i) {
      if (!take(decoded, subframe.start + i, value_of(subframe, i))) return DecodeStatus::not_finite;
    }
  }
  if (reader.status() != DecodeStatus::ok) return reader.status();
  reply = decoded;
  return DecodeStatus::ok;
}

DecodeStatus serve_frame(const MoteusDriver& driver, const CanFrame& frame, void* context,
                         MoteusRegisterReader read, MoteusRegisterWriter write, CanFrame& answer,
                         bool& answered) noexcept {
  if (!is_frame_to(driver, frame)) return DecodeStatus::not_addressed;
  CanFrame built = answer_to(driver, frame);
  SubframeWriter writer(built);
  SubframeReader reader(frame.payload());
  Subframe subframe;
  while (reader.next(subframe)) {
    std::array<double, kMaximumFrameBytes> values{};
    if (subframe.kind == SubframeKind::write) {
      for (std::uint32_t i = 0; i < subframe.count; ++i)
        write(context, subframe.start + i, value_of(subframe, i));
    } else if (subframe.kind == SubframeKind::read) {
      for (std::uint32_t i = 0; i < subframe.count; ++i) values[i] = read(context, subframe.start + i);
      writer.values(SubframeKind::reply, static_cast<MoteusRegister>(subframe.start), subframe.resolution,
                    std::span(values).first(subframe.count));
    } else {
      return DecodeStatus::malformed;
    }
  }
  if (reader.status() != DecodeStatus::ok) return reader.status();
  const EncodeStatus status = writer.finish();
  answered = (frame.id & kReplyBit) != 0 && built.length > 0 &&
             (status == EncodeStatus::ok || status == EncodeStatus::saturated);
  if (answered) answer = built;
  return DecodeStatus::ok;
}

}  // namespace stilt::hal::moteus
