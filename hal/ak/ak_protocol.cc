#include "hal/ak/ak_protocol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "hal/can/bytes.h"

namespace stilt::hal::ak {
namespace {

constexpr std::uint8_t kDisabled = 0x77;
constexpr std::array<std::uint8_t, 4> kStart{0xfa, 0xfb, 0xfc, 0xfd};
constexpr double kSpeedStep_rpm = 10;  // of the electrical field
constexpr double kCurrentStep_A = 0.01;
constexpr double kMargin = 1e-6;  // of a step: a decoded value encodes to its own code in spite of rounding

constexpr std::array kFaults{DriverFault::none,
                             DriverFault::motor_over_temperature,
                             DriverFault::over_current,
                             DriverFault::over_voltage,
                             DriverFault::under_voltage,
                             DriverFault::encoder,
                             DriverFault::driver_over_temperature,
                             DriverFault::overload};

struct Range {
  double minimum;
  double maximum;
};

constexpr Range around_zero(double maximum) noexcept { return {-maximum, maximum}; }

bool positive(double value) noexcept { return std::isfinite(value) && value > 0; }

constexpr double most(unsigned bits) noexcept { return static_cast<double>((1u << bits) - 1); }

/// Code of a finite value; reports when it had to be limited.
std::uint16_t quantize(double value, const Range& range, unsigned bits, bool& saturated) noexcept {
  const double limited = std::clamp(value, range.minimum, range.maximum);
  saturated = saturated || limited != value;
  const double code = (limited - range.minimum) * most(bits) / (range.maximum - range.minimum) + kMargin;
  return static_cast<std::uint16_t>(std::clamp(code, 0.0, most(bits)));
}

double value_of(std::uint16_t code, const Range& range, unsigned bits, bool whole_scale) noexcept {
  const double scale = most(bits) + (whole_scale ? 1 : 0);
  return range.minimum + code * (range.maximum - range.minimum) / scale;
}

std::uint8_t low_byte(unsigned value) noexcept { return static_cast<std::uint8_t>(value & 0xff); }

CanFrame extended_frame(std::uint32_t id, std::uint8_t length) noexcept {
  CanFrame frame = classic_frame(id, length);
  frame.extended = true;
  return frame;
}

bool has_id(const CanFrame& frame, std::uint32_t id) noexcept {
  return frame.id == id && frame.extended && !frame.remote && !frame.error && !frame.fd;
}

std::int64_t load(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return sign_extend(value, static_cast<unsigned>(8 * bytes.size()));
}

/// The integer part of value / step in a field of so many bytes; reports when it had to be limited.
void store(std::span<std::uint8_t> bytes, double value, double step, bool& saturated) noexcept {
  const auto end = static_cast<double>((std::uint64_t{1} << (8 * bytes.size() - 1)) - 1);
  const double steps = value / step + std::copysign(kMargin, value);
  const double limited = std::clamp(steps, -end - 1, end);
  saturated = saturated || limited != steps;
  auto code = static_cast<std::int64_t>(limited);
  for (std::size_t i = bytes.size(); i-- > 0; code >>= 8) bytes[i] = static_cast<std::uint8_t>(code & 0xff);
}

/// Velocity of the output that is 1 in a status.
double speed_step_rad_s(const AkDriver& driver) noexcept {
  return kSpeedStep_rpm * 2 * std::numbers::pi / 60 / driver.pole_pairs / driver.gear_ratio;
}

}  // namespace

bool valid(const AkDriver& driver) noexcept {
  return positive(driver.position_rad) && positive(driver.velocity_rad_s) && positive(driver.kp_Nm_rad) &&
         positive(driver.kd_Nms_rad) && positive(driver.torque_Nm) && positive(driver.status_rate_hz) &&
         driver.status_rate_hz <= kAkMost_hz && driver.pole_pairs > 0 && positive(driver.gear_ratio) &&
         std::isfinite(driver.torque_constant_Nm_A);
}

EncodeStatus encode_command(const AkDriver& driver, const AkCommand& command, CanFrame& frame) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  if (!std::isfinite(command.position_rad) || !std::isfinite(command.velocity_rad_s) ||
      !std::isfinite(command.kp_Nm_rad) || !std::isfinite(command.kd_Nms_rad) ||
      !std::isfinite(command.torque_Nm)) {
    return EncodeStatus::not_finite;
  }
  bool saturated = false;
  const unsigned kp = quantize(command.kp_Nm_rad, {0, driver.kp_Nm_rad}, 12, saturated);
  const unsigned kd = quantize(command.kd_Nms_rad, {0, driver.kd_Nms_rad}, 12, saturated);
  const unsigned position = quantize(command.position_rad, around_zero(driver.position_rad), 16, saturated);
  const unsigned velocity =
      quantize(command.velocity_rad_s, around_zero(driver.velocity_rad_s), 12, saturated);
  const unsigned torque = quantize(command.torque_Nm, around_zero(driver.torque_Nm), 12, saturated);
  frame = extended_frame(ak_id(AkMode::force_control, driver.id), 8);
  frame.data[0] = low_byte(kp >> 4);
  frame.data[1] = low_byte(kp << 4 | kd >> 8);
  frame.data[2] = low_byte(kd);
  frame.data[3] = low_byte(position >> 8);
  frame.data[4] = low_byte(position);
  frame.data[5] = low_byte(velocity >> 4);
  frame.data[6] = low_byte(velocity << 4 | torque >> 8);
  frame.data[7] = low_byte(torque);
  return saturated ? EncodeStatus::saturated : EncodeStatus::ok;
}

EncodeStatus encode_limp(const AkDriver& driver, CanFrame& frame) noexcept {
  return encode_command(driver, {}, frame);
}

CanFrame origin_frame(const AkDriver& driver, bool in_flash) noexcept {
  CanFrame frame = extended_frame(ak_id(AkMode::set_origin, driver.id), 1);
  frame.data[0] = in_flash ? 1 : 0;
  return frame;
}

DecodeStatus decode_status(const AkDriver& driver, const CanFrame& frame, AkStatus& status) noexcept {
  if (!has_id(frame, ak_id(AkReport::status, driver.id))) return DecodeStatus::not_addressed;
  if (frame.length != 8) return DecodeStatus::wrong_length;
  const auto bytes = std::span(frame.data);
  AkStatus decoded;
  decoded.position_rad = static_cast<double>(load(bytes.subspan(0, 2))) * kAkStatusStep_rad;
  decoded.velocity_rad_s = static_cast<double>(load(bytes.subspan(2, 2))) * speed_step_rad_s(driver);
  decoded.current_A = static_cast<double>(load(bytes.subspan(4, 2))) * kCurrentStep_A;
  decoded.driver_temperature_C = static_cast<double>(load(bytes.subspan(6, 1)));
  decoded.code = frame.data[7];
  decoded.disabled = decoded.code == kDisabled;
  if (!decoded.disabled)
    decoded.fault = decoded.code < kFaults.size() ? kFaults[decoded.code] : DriverFault::other;
  status = decoded;
  return DecodeStatus::ok;
}

DecodeStatus decode_position(const AkDriver& driver, const CanFrame& frame, double& position_rad) noexcept {
  if (!has_id(frame, ak_id(AkReport::position, driver.id))) return DecodeStatus::not_addressed;
  if (frame.length < 4 || frame.length > kClassicFrameBytes) return DecodeStatus::wrong_length;
  position_rad = static_cast<double>(load(std::span(frame.data).first(4))) * kAkPositionStep_rad;
  return DecodeStatus::ok;
}

bool is_start(const AkDriver& driver, const CanFrame& frame) noexcept {
  return has_id(frame, ak_id(AkReport::start, driver.id)) && frame.length >= kStart.size() &&
         std::equal(kStart.begin(), kStart.end(), frame.data.begin());
}

DecodeStatus decode_codes(std::uint8_t id, const CanFrame& frame, AkCodes& codes) noexcept {
  if (!has_id(frame, ak_id(AkMode::force_control, id))) return DecodeStatus::not_addressed;
  std::array<unsigned, kClassicFrameBytes> data{};
  std::copy_n(frame.data.begin(), std::min<std::size_t>(frame.length, data.size()), data.begin());
  codes.kp = static_cast<std::uint16_t>(data[0] << 4 | data[1] >> 4);
  codes.kd = static_cast<std::uint16_t>((data[1] & 0xf) << 8 | data[2]);
  codes.position = static_cast<std::uint16_t>(data[3] << 8 | data[4]);
  codes.velocity = static_cast<std::uint16_t>(data[5] << 4 | data[6] >> 4);
  codes.torque = static_cast<std::uint16_t>((data[6] & 0xf) << 8 | data[7]);
  return DecodeStatus::ok;
}

AkCommand command_of(const AkDriver& driver, const AkCodes& codes, bool whole_scale) noexcept {
  return {.position_rad = value_of(codes.position, around_zero(driver.position_rad), 16, whole_scale),
          .velocity_rad_s = value_of(codes.velocity, around_zero(driver.velocity_rad_s), 12, whole_scale),
          .kp_Nm_rad = value_of(codes.kp, {0, driver.kp_Nm_rad}, 12, whole_scale),
          .kd_Nms_rad = value_of(codes.kd, {0, driver.kd_Nms_rad}, 12, whole_scale),
          .torque_Nm = value_of(codes.torque, around_zero(driver.torque_Nm), 12, whole_scale)};
}

DecodeStatus decode_command(const AkDriver& driver, const CanFrame& frame, AkCommand& command) noexcept {
  AkCodes codes;
  const DecodeStatus status = decode_codes(driver.id, frame, codes);
  if (status != DecodeStatus::ok) return status;
  if (frame.length != 8) return DecodeStatus::wrong_length;
  command = command_of(driver, codes, false);
  return DecodeStatus::ok;
}

EncodeStatus encode_status(const AkDriver& driver, const AkStatus& status, CanFrame& frame) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  if (!std::isfinite(status.position_rad) || !std::isfinite(status.velocity_rad_s) ||
      !std::isfinite(status.current_A) || !std::isfinite(status.driver_temperature_C)) {
    return EncodeStatus::not_finite;
  }
  bool saturated = false;
  frame = extended_frame(ak_id(AkReport::status, driver.id), 8);
  const auto bytes = std::span(frame.data);
  store(bytes.subspan(0, 2), status.position_rad, kAkStatusStep_rad, saturated);
  store(bytes.subspan(2, 2), status.velocity_rad_s, speed_step_rad_s(driver), saturated);
  store(bytes.subspan(4, 2), status.current_A, kCurrentStep_A, saturated);
  store(bytes.subspan(6, 1), status.driver_temperature_C, 1, saturated);
  frame.data[7] = status.disabled ? kDisabled : status.code;
  return saturated ? EncodeStatus::saturated : EncodeStatus::ok;
}

EncodeStatus encode_position(const AkDriver& driver, double position_rad, std::uint8_t length,
                             CanFrame& frame) noexcept {
  if (length < 4 || length > kClassicFrameBytes) return EncodeStatus::invalid;
  if (!std::isfinite(position_rad)) return EncodeStatus::not_finite;
  bool saturated = false;
  frame = extended_frame(ak_id(AkReport::position, driver.id), length);
  store(std::span(frame.data).first(4), position_rad, kAkPositionStep_rad, saturated);
  return saturated ? EncodeStatus::saturated : EncodeStatus::ok;
}

CanFrame start_frame(const AkDriver& driver) noexcept {
  CanFrame frame = extended_frame(ak_id(AkReport::start, driver.id), kStart.size());
  std::copy(kStart.begin(), kStart.end(), frame.data.begin());
  return frame;
}

std::uint8_t ak_code(DriverFault fault) noexcept {
  const auto found = std::find(kFaults.begin(), kFaults.end(), fault);
  return static_cast<std::uint8_t>(found == kFaults.end() ? kFaults.size() - 1 : found - kFaults.begin());
}

}  // namespace stilt::hal::ak
