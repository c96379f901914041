#include "hal/mit/mit_mode.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace stilt::hal::mit {
namespace {

constexpr std::uint8_t kDamiaoDisabled = 0x0;
constexpr std::uint8_t kDamiaoEnabled = 0x1;

bool valid(const Range& range) noexcept {
  return std::isfinite(range.minimum) && std::isfinite(range.maximum) && range.minimum < range.maximum;
}

bool finite(const MitCommand& command) noexcept {
  return std::isfinite(command.position_rad) && std::isfinite(command.velocity_rad_s) &&
         std::isfinite(command.kp_Nm_rad) && std::isfinite(command.kd_Nms_rad) &&
         std::isfinite(command.torque_Nm);
}

/// Code of a finite value; reports when it had to be limited. The margin of a millionth of a step lets a
/// decoded value encode to its own code in spite of rounding.
std::uint32_t quantize(double value, const Range& range, unsigned bits, bool& saturated) noexcept {
  const double limited = std::clamp(value, range.minimum, range.maximum);
  saturated = saturated || limited != value;
  const double top = static_cast<double>((1u << bits) - 1);
  const double code = (limited - range.minimum) * top / (range.maximum - range.minimum) + 1e-6;
  return static_cast<std::uint32_t>(std::clamp(code, 0.0, top));
}

double value_of(std::uint32_t code, const Range& range, unsigned bits) noexcept {
  return range.minimum + static_cast<double>(code) * step(range, bits);
}

std::uint8_t low_byte(std::uint32_t value) noexcept { return static_cast<std::uint8_t>(value & 0xff); }

bool is_special(std::span<const std::uint8_t> bytes) noexcept {
  return std::all_of(bytes.begin(), bytes.begin() + 7, [](std::uint8_t byte) { return byte == 0xff; }) &&
         bytes[7] >= static_cast<std::uint8_t>(MitSpecial::clear_error) &&
         bytes[7] <= static_cast<std::uint8_t>(MitSpecial::set_zero);
}

bool classic_data(const CanFrame& frame, std::uint32_t id) noexcept {
  return frame.id == id && !frame.extended && !frame.remote && !frame.error && !frame.fd;
}

DriverFault damiao_fault(std::uint8_t status) noexcept {
  switch (status) {
    case kDamiaoDisabled:
    case kDamiaoEnabled:
      return DriverFault::none;
    case 0x5:
      return DriverFault::encoder;
    case 0x6:
      return DriverFault::configuration;
    case 0x8:
      return DriverFault::over_voltage;
    case 0x9:
      return DriverFault::under_voltage;
    case 0xa:
      return DriverFault::over_current;
    case 0xb:
      return DriverFault::driver_over_temperature;
    case 0xc:
      return DriverFault::motor_over_temperature;
    case 0xd:
      return DriverFault::lost_communication;
    case 0xe:
      return DriverFault::overload;
    default:
      return DriverFault::other;
  }
}

DriverFault ak_fault(std::uint8_t code) noexcept {
  switch (code) {
    case 0:
      return DriverFault::none;
    case 1:
      return DriverFault::motor_over_temperature;
    case 2:
      return DriverFault::over_current;
    case 3:
      return DriverFault::over_voltage;
    case 4:
      return DriverFault::under_voltage;
    case 5:
      return DriverFault::encoder;
    case 6:
      return DriverFault::driver_over_temperature;
    case 7:
      return DriverFault::overload;
    default:
      return DriverFault::other;
  }
}

bool length_fits(ReplyLayout layout, std::uint8_t length) noexcept {
  return layout == ReplyLayout::mini_cheetah ? length == 6 || length == 7 : length == 8;
}

void decode_extras(const MitDriver& driver, const CanFrame& frame, MitReply& reply) noexcept {
  switch (driver.layout) {
    case ReplyLayout::mini_cheetah:
      if (frame.length == 7) reply.supply_V = value_of(frame.data[6], driver.supply_V, 8);
      break;
    case ReplyLayout::ak:
      reply.driver_temperature_C = frame.data[6] + driver.temperature_offset_C;
      reply.fault_code = frame.data[7];
      reply.fault = ak_fault(reply.fault_code);
      break;
    case ReplyLayout::damiao:
      reply.fault_code = frame.data[0] >> 4;
      reply.fault = damiao_fault(reply.fault_code);
      reply.reports_enabled = true;
      reply.enabled = reply.fault_code == kDamiaoEnabled;
      reply.driver_temperature_C = frame.data[6];
      reply.motor_temperature_C = frame.data[7];
      break;
  }
}

std::uint8_t byte_of(double value) noexcept {
  return std::isfinite(value) ? static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))) : 0;
}

void encode_extras(const MitDriver& driver, const MitReply& reply, CanFrame& frame) noexcept {
  frame.length = 8;
  switch (driver.layout) {
    case ReplyLayout::mini_cheetah: {
      bool saturated = false;
      frame.length = std::isfinite(reply.supply_V) ? 7 : 6;
      frame.data[6] =
          frame.length == 7 ? low_byte(quantize(reply.supply_V, driver.supply_V, 8, saturated)) : 0;
      break;
    }
    case ReplyLayout::ak:
      frame.data[6] = byte_of(reply.driver_temperature_C - driver.temperature_offset_C);
      frame.data[7] = reply.fault_code;
      break;
    case ReplyLayout::damiao:
      frame.data[0] = static_cast<std::uint8_t>((reply.fault_code & 0xf) << 4 | (driver.driver_id & 0xf));
      frame.data[6] = byte_of(reply.driver_temperature_C);
      frame.data[7] = byte_of(reply.motor_temperature_C);
      break;
  }
}

}  // namespace

bool valid(const MitDriver& driver) noexcept {
  return driver.command_id <= kMaximumStandardId && driver.reply_id <= kMaximumStandardId &&
         (driver.layout != ReplyLayout::damiao || driver.driver_id <= 0xf) && valid(driver.position_rad) &&
         valid(driver.velocity_rad_s) && valid(driver.kp_Nm_rad) && valid(driver.kd_Nms_rad) &&
         valid(driver.torque_Nm) && valid(driver.reply_position_rad) && valid(driver.reply_velocity_rad_s) &&
         valid(driver.reply_torque_Nm) && valid(driver.supply_V) &&
         std::isfinite(driver.temperature_offset_C);
}

EncodeStatus encode_command(const MitDriver& driver, const MitCommand& command, CanFrame& frame) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  if (!finite(command)) return EncodeStatus::not_finite;
  bool saturated = false;
  const std::uint32_t position = quantize(command.position_rad, driver.position_rad, 16, saturated);
  const std::uint32_t velocity = quantize(command.velocity_rad_s, driver.velocity_rad_s, 12, saturated);
  const std::uint32_t kp = quantize(command.kp_Nm_rad, driver.kp_Nm_rad, 12, saturated);
  std::uint32_t kd = quantize(command.kd_Nms_rad, driver.kd_Nms_rad, 12, saturated);
  const std::uint32_t torque = quantize(command.torque_Nm, driver.torque_Nm, 12, saturated);
  frame = classic_frame(driver.command_id, 8);
  frame.data[0] = low_byte(position >> 8);
  frame.data[1] = low_byte(position);
  frame.data[2] = low_byte(velocity >> 4);
  frame.data[3] = low_byte(velocity << 4 | kp >> 8);
  frame.data[4] = low_byte(kp);
  frame.data[5] = low_byte(kd >> 4);
  frame.data[6] = low_byte(kd << 4 | torque >> 8);
  frame.data[7] = low_byte(torque);
  if (is_special(frame.payload())) {
    kd -= 1;
    frame.data[6] = low_byte(kd << 4 | torque >> 8);
    saturated = true;
  }
  return saturated ? EncodeStatus::saturated : EncodeStatus::ok;
}

DecodeStatus decode_command(const MitDriver& driver, const CanFrame& frame, MitCommand& command) noexcept {
  if (!classic_data(frame, driver.command_id)) return DecodeStatus::not_addressed;
  if (frame.length != 8) return DecodeStatus::wrong_length;
  const auto& data = frame.data;
  if (is_special(frame.payload())) return DecodeStatus::malformed;
  command.position_rad = value_of(data[0] << 8 | data[1], driver.position_rad, 16);
  command.velocity_rad_s = value_of(data[2] << 4 | data[3] >> 4, driver.velocity_rad_s, 12);
  command.kp_Nm_rad = value_of((data[3] & 0xf) << 8 | data[4], driver.kp_Nm_rad, 12);
  command.kd_Nms_rad = value_of(data[5] << 4 | data[6] >> 4, driver.kd_Nms_rad, 12);
  command.torque_Nm = value_of((data[6] & 0xf) << 8 | data[7], driver.torque_Nm, 12);
  return DecodeStatus::ok;
}

DecodeStatus decode_reply(const MitDriver& driver, const CanFrame& frame, MitReply& reply) noexcept {
  if (!classic_data(frame, driver.reply_id)) return DecodeStatus::not_addressed;
  if (!length_fits(driver.layout, frame.length)) return DecodeStatus::wrong_length;
  const auto& data = frame.data;
  if ((data[0] & sender_mask(driver)) != driver.driver_id) return DecodeStatus::not_addressed;
  MitReply decoded;
  decoded.position_rad = value_of(data[1] << 8 | data[2], driver.reply_position_rad, 16);
  decoded.velocity_rad_s = value_of(data[3] << 4 | data[4] >> 4, driver.reply_velocity_rad_s, 12);
  decoded.torque_Nm = value_of((data[4] & 0xf) << 8 | data[5], driver.reply_torque_Nm, 12);
  decode_extras(driver, frame, decoded);
  reply = decoded;
  return DecodeStatus::ok;
}

EncodeStatus encode_reply(const MitDriver& driver, const MitReply& reply, CanFrame& frame) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  if (!std::isfinite(reply.position_rad) || !std::isfinite(reply.velocity_rad_s) ||
      !std::isfinite(reply.torque_Nm)) {
    return EncodeStatus::not_finite;
  }
  bool saturated = false;
  const std::uint32_t position = quantize(reply.position_rad, driver.reply_position_rad, 16, saturated);
  const std::uint32_t velocity = quantize(reply.velocity_rad_s, driver.reply_velocity_rad_s, 12, saturated);
  const std::uint32_t torque = quantize(reply.torque_Nm, driver.reply_torque_Nm, 12, saturated);
  frame = classic_frame(driver.reply_id, 8);
  frame.data[0] = driver.driver_id;
  frame.data[1] = low_byte(position >> 8);
  frame.data[2] = low_byte(position);
  frame.data[3] = low_byte(velocity >> 4);
  frame.data[4] = low_byte(velocity << 4 | torque >> 8);
  frame.data[5] = low_byte(torque);
  encode_extras(driver, reply, frame);
  return saturated ? EncodeStatus::saturated : EncodeStatus::ok;
}

CanFrame special_frame(const MitDriver& driver, MitSpecial special) noexcept {
  CanFrame frame = classic_frame(driver.command_id, 8);
  std::fill_n(frame.data.begin(), 7, std::uint8_t{0xff});
  frame.data[7] = static_cast<std::uint8_t>(special);
  return frame;
}

DecodeStatus decode_special(const MitDriver& driver, const CanFrame& frame, MitSpecial& special) noexcept {
  if (!classic_data(frame, driver.command_id)) return DecodeStatus::not_addressed;
  if (frame.length != 8) return DecodeStatus::wrong_length;
  if (!is_special(frame.payload())) return DecodeStatus::malformed;
  special = static_cast<MitSpecial>(frame.data[7]);
  return DecodeStatus::ok;
}

}  // namespace stilt::hal::mit
