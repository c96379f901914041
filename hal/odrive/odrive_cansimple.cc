#include "hal/odrive/odrive_cansimple.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "hal/can/bytes.h"

namespace stilt::hal::odrive {
namespace {

constexpr std::uint8_t kOpcodeRead = 0x00;
constexpr std::uint8_t kOpcodeWrite = 0x01;
constexpr double kThousandth = 0.001;

constexpr std::uint32_t frame_id(std::uint8_t node, OdriveCommand command) noexcept {
  return static_cast<std::uint32_t>(node) << 5 | static_cast<std::uint32_t>(command);
}

EncodeStatus begin(std::uint8_t node, OdriveCommand command, std::uint8_t length, CanFrame& frame) noexcept {
  if (node > kOdriveMaximumNode) return EncodeStatus::invalid;
  frame = classic_frame(frame_id(node, command), length);
  return EncodeStatus::ok;
}

DecodeStatus expect(std::uint8_t node, OdriveCommand command, std::uint8_t length,
                    const CanFrame& frame) noexcept {
  if (frame.id != frame_id(node, command) || frame.extended || frame.remote || frame.error || frame.fd) {
    return DecodeStatus::not_addressed;
  }
  return frame.length == length ? DecodeStatus::ok : DecodeStatus::wrong_length;
}

std::span<std::uint8_t> four(CanFrame& frame, std::size_t offset) noexcept {
  return std::span(frame.data).subspan(offset, 4);
}
std::span<const std::uint8_t> four(const CanFrame& frame, std::size_t offset) noexcept {
  return std::span(frame.data).subspan(offset, 4);
}
std::uint32_t word(const CanFrame& frame, std::size_t offset) noexcept {
  return static_cast<std::uint32_t>(load_little(four(frame, offset)));
}

/// Two words of one message.
EncodeStatus encode_words(std::uint8_t node, OdriveCommand command, std::uint32_t first, std::uint32_t second,
                          CanFrame& frame) noexcept {
  const EncodeStatus status = begin(node, command, 8, frame);
  if (status != EncodeStatus::ok) return status;
  store_little(four(frame, 0), first);
  store_little(four(frame, 4), second);
  return status;
}

/// A number as float: finite and inside its range; reports when it was limited.
float limited_float(double value, bool& saturated) noexcept {
  constexpr double kLargest = std::numeric_limits<float>::max();
  const double limited = std::clamp(value, -kLargest, kLargest);
  saturated = saturated || limited != value;
  return static_cast<float>(limited);
}

EncodeStatus encode_floats(std::uint8_t node, OdriveCommand command, double first, double second,
                           CanFrame& frame) noexcept {
  if (!std::isfinite(first)) return EncodeStatus::not_finite;
  bool saturated = false;
  const float first_float = limited_float(first, saturated);
  const float second_float =
      std::isnan(second) ? std::numeric_limits<float>::quiet_NaN() : limited_float(second, saturated);
  const EncodeStatus status = encode_words(node, command, std::bit_cast<std::uint32_t>(first_float),
                                           std::bit_cast<std::uint32_t>(second_float), frame);
  return status == EncodeStatus::ok && saturated ? EncodeStatus::saturated : status;
}

DecodeStatus decode_floats(std::uint8_t node, OdriveCommand command, const CanFrame& frame, double& first,
                           double& second) noexcept {
  const DecodeStatus status = expect(node, command, 8, frame);
  if (status != DecodeStatus::ok) return status;
  const float first_float = load_float(four(frame, 0));
  const float second_float = load_float(four(frame, 4));
  const bool may_lack_second = command == OdriveCommand::temperature && std::isnan(second_float);
  if (!std::isfinite(first_float) || !(std::isfinite(second_float) || may_lack_second)) {
    return DecodeStatus::not_finite;
  }
  first = first_float;
  second = second_float;
  return DecodeStatus::ok;
}

std::uint16_t thousandths(double value, bool& saturated) noexcept {
  const double scaled = std::round(value / kThousandth);
  const double limited = std::clamp(scaled, -32768.0, 32767.0);
  saturated = saturated || limited != scaled;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(limited) & 0xffff);
}

bool allowed_value_bytes(std::uint8_t bytes) noexcept {
  return bytes == 0 || bytes == 1 || bytes == 2 || bytes == 4;
}

EncodeStatus encode_parameter(std::uint8_t node, OdriveCommand command, std::uint8_t opcode, bool with_value,
                              const OdriveParameter& parameter, CanFrame& frame) noexcept {
  if (!allowed_value_bytes(parameter.value_bytes)) return EncodeStatus::invalid;
  const std::uint8_t value_bytes = with_value ? parameter.value_bytes : 0;
  const EncodeStatus status = begin(node, command, static_cast<std::uint8_t>(4 + value_bytes), frame);
  if (status != EncodeStatus::ok) return status;
  frame.data[0] = opcode;
  store_little(std::span(frame.data).subspan(1, 2), parameter.endpoint);
  store_little(std::span(frame.data).subspan(4, value_bytes), parameter.bits);
  return status;
}

DecodeStatus decode_parameter(std::uint8_t node, OdriveCommand command, const CanFrame& frame,
                              OdriveParameter& parameter) noexcept {
  const DecodeStatus status = expect(node, command, frame.length, frame);
  if (status != DecodeStatus::ok) return status;
  if (frame.length < 4 || frame.length > 8 ||
      !allowed_value_bytes(static_cast<std::uint8_t>(frame.length - 4))) {
    return DecodeStatus::wrong_length;
  }
  const std::uint8_t opcode = frame.data[0];
  const bool request = command == OdriveCommand::parameter_request;
  if (request && opcode != kOpcodeRead && opcode != kOpcodeWrite) return DecodeStatus::malformed;
  parameter.write = request && opcode == kOpcodeWrite;
  parameter.endpoint = static_cast<std::uint16_t>(load_little(std::span(frame.data).subspan(1, 2)));
  parameter.value_bytes = static_cast<std::uint8_t>(frame.length - 4);
  parameter.bits =
      static_cast<std::uint32_t>(load_little(std::span(frame.data).subspan(4, parameter.value_bytes)));
  return DecodeStatus::ok;
}

struct ErrorBit {
  std::uint32_t bit;
  DriverFault fault;
};

/// ODrive.Error of firmware 0.6, the most specific first.
constexpr std::array<ErrorBit, 21> kErrorBits{{
    {0x02000000, DriverFault::emergency_stop},  // ESTOP_REQUESTED
    {kOdriveWatchdogExpired, DriverFault::lost_communication},
    {0x00000100, DriverFault::over_voltage},
    {0x00000200, DriverFault::under_voltage},
    {0x00000400, DriverFault::over_current},  // DC_BUS_OVER_CURRENT
    {0x00000800, DriverFault::over_voltage},  // DC_BUS_OVER_REGEN_CURRENT
    {0x00001000, DriverFault::over_current},  // CURRENT_LIMIT_VIOLATION
    {0x00002000, DriverFault::motor_over_temperature},
    {0x00004000, DriverFault::driver_over_temperature},
    {0x00008000, DriverFault::velocity_limit},
    {0x00010000, DriverFault::position_limit},
    {0x00000008, DriverFault::encoder},        // MISSING_ESTIMATE
    {0x04000000, DriverFault::encoder},        // SPINOUT_DETECTED
    {0x00000020, DriverFault::gate_driver},    // DRV_FAULT
    {0x00000010, DriverFault::configuration},  // BAD_CONFIG
    {0x00000040, DriverFault::configuration},  // MISSING_INPUT
    {0x40000000, DriverFault::configuration},  // CALIBRATION_ERROR
    {0x08000000, DriverFault::configuration},  // BRAKE_RESISTOR_DISARMED
    {0x10000000, DriverFault::configuration},  // THERMISTOR_DISCONNECTED
    {0x00000001, DriverFault::configuration},  // INITIALIZING
    {0x00000002, DriverFault::other},          // SYSTEM_LEVEL
}};

}  // namespace

DriverFault odrive_fault(std::uint32_t errors) noexcept {
  if (errors == 0) return DriverFault::none;
  for (const ErrorBit& entry : kErrorBits) {
    if (errors & entry.bit) return entry.fault;
  }
  return DriverFault::other;
}

EncodeStatus encode_request(std::uint8_t node, OdriveCommand what, CanFrame& frame) noexcept {
  const EncodeStatus status = begin(node, what, 0, frame);
  if (status == EncodeStatus::ok) frame.remote = true;
  return status;
}

EncodeStatus encode_set_state(std::uint8_t node, std::uint32_t state, CanFrame& frame) noexcept {
  const EncodeStatus status = begin(node, OdriveCommand::set_state, 4, frame);
  if (status == EncodeStatus::ok) store_little(four(frame, 0), state);
  return status;
}

EncodeStatus encode_set_controller_mode(std::uint8_t node, OdriveControlMode control, OdriveInputMode input,
                                        CanFrame& frame) noexcept {
  return encode_words(node, OdriveCommand::set_controller_mode, static_cast<std::uint32_t>(control),
                      static_cast<std::uint32_t>(input), frame);
}

EncodeStatus encode_input_torque(std::uint8_t node, double torque_Nm, CanFrame& frame) noexcept {
  if (!std::isfinite(torque_Nm)) return EncodeStatus::not_finite;
  const EncodeStatus status = begin(node, OdriveCommand::set_input_torque, 4, frame);
  if (status != EncodeStatus::ok) return status;
  bool saturated = false;
  store_float(four(frame, 0), limited_float(torque_Nm, saturated));
  return saturated ? EncodeStatus::saturated : EncodeStatus::ok;
}

EncodeStatus encode_input_position(std::uint8_t node, double position_rad, double velocity_rad_s,
                                   double torque_Nm, CanFrame& frame) noexcept {
  if (!std::isfinite(position_rad) || !std::isfinite(velocity_rad_s) || !std::isfinite(torque_Nm)) {
    return EncodeStatus::not_finite;
  }
  const EncodeStatus status = begin(node, OdriveCommand::set_input_position, 8, frame);
  if (status != EncodeStatus::ok) return status;
  bool saturated = false;
  store_float(four(frame, 0), limited_float(position_rad / kRadiansPerRevolution, saturated));
  store_little(std::span(frame.data).subspan(4, 2),
               thousandths(velocity_rad_s / kRadiansPerRevolution, saturated));
  store_little(std::span(frame.data).subspan(6, 2), thousandths(torque_Nm, saturated));
  return saturated ? EncodeStatus::saturated : EncodeStatus::ok;
}

EncodeStatus encode_clear_errors(std::uint8_t node, CanFrame& frame) noexcept {
  return begin(node, OdriveCommand::clear_errors, 1, frame);  // byte 0: identify, off
}

EncodeStatus encode_emergency_stop(std::uint8_t node, CanFrame& frame) noexcept {
  return begin(node, OdriveCommand::emergency_stop, 0, frame);
}

EncodeStatus encode_parameter_request(std::uint8_t node, const OdriveParameter& parameter,
                                      CanFrame& frame) noexcept {
  return encode_parameter(node, OdriveCommand::parameter_request,
                          parameter.write ? kOpcodeWrite : kOpcodeRead, parameter.write, parameter, frame);
}

EncodeStatus encode_parameter_answer(std::uint8_t node, const OdriveParameter& parameter,
                                     CanFrame& frame) noexcept {
  return encode_parameter(node, OdriveCommand::parameter_answer, 0, true, parameter, frame);
}

DecodeStatus decode_parameter_answer(std::uint8_t node, const CanFrame& frame,
                                     OdriveParameter& parameter) noexcept {
  return decode_parameter(node, OdriveCommand::parameter_answer, frame, parameter);
}

DecodeStatus decode_parameter_request(std::uint8_t node, const CanFrame& frame,
                                      OdriveParameter& parameter) noexcept {
  return decode_parameter(node, OdriveCommand::parameter_request, frame, parameter);
}

EncodeStatus encode(std::uint8_t node, const OdriveVersion& version, CanFrame& frame) noexcept {
  const EncodeStatus status = begin(node, OdriveCommand::version, 8, frame);
  if (status != EncodeStatus::ok) return status;
  const std::array<std::uint8_t, 8> bytes{
      version.protocol,       version.hardware_line,  version.hardware_version,  version.hardware_variant,
      version.firmware_major, version.firmware_minor, version.firmware_revision, version.firmware_unreleased};
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  return status;
}

DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveVersion& version) noexcept {
  const DecodeStatus status = expect(node, OdriveCommand::version, 8, frame);
  if (status != DecodeStatus::ok) return status;
  const auto& data = frame.data;
  version = {data[0], data[1], data[2], data[3], data[4], data[5], data[6], data[7]};
  return status;
}

EncodeStatus encode(std::uint8_t node, const OdriveHeartbeat& heartbeat, CanFrame& frame) noexcept {
  const EncodeStatus status = begin(node, OdriveCommand::heartbeat, 8, frame);
  if (status != EncodeStatus::ok) return status;
  store_little(four(frame, 0), heartbeat.errors);
  frame.data[4] = heartbeat.state;
  frame.data[5] = heartbeat.procedure_result;
  frame.data[6] = heartbeat.trajectory_done ? 1 : 0;
  return status;
}

DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveHeartbeat& heartbeat) noexcept {
  // Firmware sends 8 bytes; the last is reserved and some revisions leave it out.
  if (expect(node, OdriveCommand::heartbeat, frame.length, frame) != DecodeStatus::ok)
    return DecodeStatus::not_addressed;
  if (frame.length != 7 && frame.length != 8) return DecodeStatus::wrong_length;
  heartbeat.errors = word(frame, 0);
  heartbeat.state = frame.data[4];
  heartbeat.procedure_result = frame.data[5];
  heartbeat.trajectory_done = frame.data[6] != 0;
  return DecodeStatus::ok;
}

EncodeStatus encode(std::uint8_t node, const OdriveErrors& errors, CanFrame& frame) noexcept {
  return encode_words(node, OdriveCommand::errors, errors.active, errors.disarm_reason, frame);
}

DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveErrors& errors) noexcept {
  const DecodeStatus status = expect(node, OdriveCommand::errors, 8, frame);
  if (status == DecodeStatus::ok) errors = {word(frame, 0), word(frame, 4)};
  return status;
}

EncodeStatus encode(std::uint8_t node, const OdriveEstimates& estimates, CanFrame& frame) noexcept {
  if (!std::isfinite(estimates.velocity_rad_s)) return EncodeStatus::not_finite;
  return encode_floats(node, OdriveCommand::encoder_estimates, estimates.position_rad / kRadiansPerRevolution,
                       estimates.velocity_rad_s / kRadiansPerRevolution, frame);
}

DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveEstimates& estimates) noexcept {
  double position_rev = 0;
  double velocity_rev_s = 0;
  const DecodeStatus status =
      decode_floats(node, OdriveCommand::encoder_estimates, frame, position_rev, velocity_rev_s);
  if (status == DecodeStatus::ok) {
    estimates = {position_rev * kRadiansPerRevolution, velocity_rev_s * kRadiansPerRevolution};
  }
  return status;
}

EncodeStatus encode(std::uint8_t node, const OdriveTorques& torques, CanFrame& frame) noexcept {
  if (!std::isfinite(torques.estimate_Nm)) return EncodeStatus::not_finite;
  return encode_floats(node, OdriveCommand::torques, torques.target_Nm, torques.estimate_Nm, frame);
}

DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveTorques& torques) noexcept {
  return decode_floats(node, OdriveCommand::torques, frame, torques.target_Nm, torques.estimate_Nm);
}

bool is_torques(std::uint8_t node, const CanFrame& frame) noexcept {
  return expect(node, OdriveCommand::torques, 8, frame) == DecodeStatus::ok;
}

EncodeStatus encode(std::uint8_t node, const OdriveTemperatures& temperatures, CanFrame& frame) noexcept {
  return encode_floats(node, OdriveCommand::temperature, temperatures.driver_C, temperatures.motor_C, frame);
}

DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveTemperatures& temperatures) noexcept {
  return decode_floats(node, OdriveCommand::temperature, frame, temperatures.driver_C, temperatures.motor_C);
}

EncodeStatus encode(std::uint8_t node, const OdriveSupply& supply, CanFrame& frame) noexcept {
  if (!std::isfinite(supply.current_A)) return EncodeStatus::not_finite;
  return encode_floats(node, OdriveCommand::supply, supply.voltage_V, supply.current_A, frame);
}

DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveSupply& supply) noexcept {
  return decode_floats(node, OdriveCommand::supply, frame, supply.voltage_V, supply.current_A);
}

DecodeStatus decode_command(std::uint8_t node, const CanFrame& frame, OdriveCommand& command) noexcept {
  if (frame.extended || frame.error || frame.fd || frame.id >> 5 != node) return DecodeStatus::not_addressed;
  command = static_cast<OdriveCommand>(frame.id & 0x1f);
  return DecodeStatus::ok;
}

DecodeStatus decode_set_state(std::uint8_t node, const CanFrame& frame, std::uint32_t& state) noexcept {
  // Hosts send 4 bytes or, after the older data base, 8.
  if (expect(node, OdriveCommand::set_state, frame.length, frame) != DecodeStatus::ok)
    return DecodeStatus::not_addressed;
  if (frame.length != 4 && frame.length != 8) return DecodeStatus::wrong_length;
  state = word(frame, 0);
  return DecodeStatus::ok;
}

DecodeStatus decode_set_controller_mode(std::uint8_t node, const CanFrame& frame, std::uint32_t& control,
                                        std::uint32_t& input) noexcept {
  const DecodeStatus status = expect(node, OdriveCommand::set_controller_mode, 8, frame);
  if (status != DecodeStatus::ok) return status;
  control = word(frame, 0);
  input = word(frame, 4);
  return status;
}

DecodeStatus decode_input_torque(std::uint8_t node, const CanFrame& frame, double& torque_Nm) noexcept {
  if (expect(node, OdriveCommand::set_input_torque, frame.length, frame) != DecodeStatus::ok) {
    return DecodeStatus::not_addressed;
  }
  if (frame.length != 4 && frame.length != 8) return DecodeStatus::wrong_length;
  const float value = load_float(four(frame, 0));
  if (!std::isfinite(value)) return DecodeStatus::not_finite;
  torque_Nm = value;
  return DecodeStatus::ok;
}

DecodeStatus decode_input_position(std::uint8_t node, const CanFrame& frame,
                                   OdriveInputPosition& input) noexcept {
  const DecodeStatus status = expect(node, OdriveCommand::set_input_position, 8, frame);
  if (status != DecodeStatus::ok) return status;
  const float position_rev = load_float(four(frame, 0));
  if (!std::isfinite(position_rev)) return DecodeStatus::not_finite;
  const auto signed16 = [&frame](std::size_t offset) {
    return static_cast<double>(sign_extend(load_little(std::span(frame.data).subspan(offset, 2)), 16));
  };
  input = {position_rev * kRadiansPerRevolution, signed16(4) * kThousandth * kRadiansPerRevolution,
           signed16(6) * kThousandth};
  return status;
}

}  // namespace stilt::hal::odrive
