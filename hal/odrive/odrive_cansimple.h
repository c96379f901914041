#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "hal/can/codec_status.h"
#include "hal/can/frame.h"
#include "hal/driver/driver_fault.h"

/// ODrive CANSimple (firmware 0.6): classic frames, identifier = node << 5 | command, little endian.
/// Positions and velocities are in revolutions of the motor shaft on the wire, in radians of that shaft here.
/// There is no command with gains: the controller closes the loop and sends torques, and a watchdog that is
/// off by default. Of the messages only those called Get_ answer a request; the heartbeat comes by its timer.
/// Facts: docs.odriverobotics.com/v/latest/manual/can-protocol.html; github.com/odriverobotics/ODrive,
/// tools/odrive-cansimple.dbc; github.com/odriverobotics/ODriveResources, examples/can_param_access.py.
/// Real-time safe, without state.
namespace stilt::hal::odrive {

/// Number of a message, the low five bits of its identifier.
enum class OdriveCommand : std::uint8_t {
  version = 0x00,
  heartbeat = 0x01,
  emergency_stop = 0x02,
  errors = 0x03,
  parameter_request = 0x04,  ///< RxSdo
  parameter_answer = 0x05,   ///< TxSdo
  set_state = 0x07,
  encoder_estimates = 0x09,
  set_controller_mode = 0x0b,
  set_input_position = 0x0c,
  set_input_torque = 0x0e,
  temperature = 0x15,
  supply = 0x17,
  clear_errors = 0x18,
  torques = 0x1c,
};

inline constexpr std::uint8_t kOdriveMaximumNode = 0x3f;

/// Numbers of the parameters, from flat_endpoints.json of one release for one hardware; 0: unknown.
struct OdriveEndpoints {
  std::uint16_t watchdog_timeout = 0;   ///< axis0.config.watchdog_timeout, float, s
  std::uint16_t enable_watchdog = 0;    ///< axis0.config.enable_watchdog, bool
  std::uint16_t torque_mode_limit = 0;  ///< axis0.controller.config.enable_torque_mode_vel_limit, bool
  std::uint16_t velocity_limit = 0;     ///< axis0.controller.config.vel_limit, float, rev/s
  std::uint32_t firmware_version = 0;   ///< of that file, as firmware_number()
  std::uint32_t hardware_version = 0;   ///< likewise, as hardware_number()

  [[nodiscard]] constexpr bool any() const noexcept {
    return watchdog_timeout != 0 || enable_watchdog != 0 || torque_mode_limit != 0 || velocity_limit != 0;
  }
};

/// A driver: its node, and the parameters that bring-up may use.
struct OdriveDriver {
  std::uint8_t node = 1;
  OdriveEndpoints endpoints;
};

enum class OdriveState : std::uint8_t { undefined = 0, idle = 1, closed_loop = 8 };  ///< others exist
enum class OdriveControlMode : std::uint8_t { torque = 1, velocity = 2, position = 3 };
enum class OdriveInputMode : std::uint8_t { inactive = 0, passthrough = 1 };

/// Answer to OdriveCommand::version.
struct OdriveVersion {
  std::uint8_t protocol = 2;
  std::uint8_t hardware_line = 0;
  std::uint8_t hardware_version = 0;
  std::uint8_t hardware_variant = 0;
  std::uint8_t firmware_major = 0;
  std::uint8_t firmware_minor = 0;
  std::uint8_t firmware_revision = 0;
  std::uint8_t firmware_unreleased = 0;
  friend bool operator==(const OdriveVersion&, const OdriveVersion&) = default;
};

/// State and errors of the axis, sent periodically.
struct OdriveHeartbeat {
  std::uint32_t errors = 0;  ///< bits, see odrive_fault
  std::uint8_t state = 0;    ///< OdriveState
  std::uint8_t procedure_result = 0;
  bool trajectory_done = false;
  friend bool operator==(const OdriveHeartbeat&, const OdriveHeartbeat&) = default;
};

/// Bits as in OdriveHeartbeat::errors: now, and when the axis was last disarmed.
struct OdriveErrors {
  std::uint32_t active = 0;
  std::uint32_t disarm_reason = 0;
  friend bool operator==(const OdriveErrors&, const OdriveErrors&) = default;
};

/// Of the encoder, at the motor's shaft.
struct OdriveEstimates {
  double position_rad = 0;
  double velocity_rad_s = 0;
};

/// At the motor's shaft.
struct OdriveTorques {
  double target_Nm = 0;
  double estimate_Nm = 0;
};

/// Of the transistors and the motor.
struct OdriveTemperatures {
  double driver_C = 0;
  double motor_C = std::numeric_limits<double>::quiet_NaN();  ///< NaN without a sensor
};

/// Voltage and current of the supply.
struct OdriveSupply {
  double voltage_V = 0;
  double current_A = 0;
};

/// Read or write of a parameter by its number, which depends on the firmware (flat_endpoints.json of the
/// release).
struct OdriveParameter {
  bool write = false;  ///< request only
  std::uint16_t endpoint = 0;
  std::uint32_t bits = 0;        ///< value, up to four bytes: integer, or the bits of a float
  std::uint8_t value_bytes = 4;  ///< 0, 1, 2 or 4
};

inline constexpr std::uint32_t kOdriveWatchdogExpired = 0x01000000;

/// Most serious of the error bits. None for 0.
[[nodiscard]] DriverFault odrive_fault(std::uint32_t errors) noexcept;

[[nodiscard]] constexpr bool valid(const OdriveDriver& driver) noexcept {
  return driver.node <= kOdriveMaximumNode;
}

// To the driver. invalid: node above 63.
[[nodiscard]] EncodeStatus encode_request(std::uint8_t node, OdriveCommand what, CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode_set_state(std::uint8_t node, std::uint32_t state, CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode_set_controller_mode(std::uint8_t node, OdriveControlMode control,
                                                      OdriveInputMode input, CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode_input_torque(std::uint8_t node, double torque_Nm, CanFrame& frame) noexcept;
/// Velocity and torque are int16 thousandths on the wire (rev/s, Nm) and saturate there.
[[nodiscard]] EncodeStatus encode_input_position(std::uint8_t node, double position_rad,
                                                 double velocity_rad_s, double torque_Nm,
                                                 CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode_clear_errors(std::uint8_t node, CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode_emergency_stop(std::uint8_t node, CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode_parameter_request(std::uint8_t node, const OdriveParameter& parameter,
                                                    CanFrame& frame) noexcept;

// From the driver.
[[nodiscard]] DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveVersion& version) noexcept;
[[nodiscard]] DecodeStatus decode(std::uint8_t node, const CanFrame& frame,
                                  OdriveHeartbeat& heartbeat) noexcept;
[[nodiscard]] DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveErrors& errors) noexcept;
[[nodiscard]] DecodeStatus decode(std::uint8_t node, const CanFrame& frame,
                                  OdriveEstimates& estimates) noexcept;
[[nodiscard]] DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveTorques& torques) noexcept;
/// Torques of this node, also while they are not yet numbers.
[[nodiscard]] bool is_torques(std::uint8_t node, const CanFrame& frame) noexcept;
[[nodiscard]] DecodeStatus decode(std::uint8_t node, const CanFrame& frame,
                                  OdriveTemperatures& temperatures) noexcept;
[[nodiscard]] DecodeStatus decode(std::uint8_t node, const CanFrame& frame, OdriveSupply& supply) noexcept;
/// An answer whose value is shorter than four bytes leaves the high bytes zero.
[[nodiscard]] DecodeStatus decode_parameter_answer(std::uint8_t node, const CanFrame& frame,
                                                   OdriveParameter& parameter) noexcept;

// The driver's side: for emulated drivers and tests.
/// Target with feed-forward velocity and torque, at the motor's shaft.
struct OdriveInputPosition {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double torque_Nm = 0;
};
[[nodiscard]] EncodeStatus encode(std::uint8_t node, const OdriveVersion& version, CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode(std::uint8_t node, const OdriveHeartbeat& heartbeat,
                                  CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode(std::uint8_t node, const OdriveErrors& errors, CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode(std::uint8_t node, const OdriveEstimates& estimates,
                                  CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode(std::uint8_t node, const OdriveTorques& torques, CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode(std::uint8_t node, const OdriveTemperatures& temperatures,
                                  CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode(std::uint8_t node, const OdriveSupply& supply, CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode_parameter_answer(std::uint8_t node, const OdriveParameter& parameter,
                                                   CanFrame& frame) noexcept;
/// not_addressed: not a frame of this node.
[[nodiscard]] DecodeStatus decode_command(std::uint8_t node, const CanFrame& frame,
                                          OdriveCommand& command) noexcept;
[[nodiscard]] DecodeStatus decode_set_state(std::uint8_t node, const CanFrame& frame,
                                            std::uint32_t& state) noexcept;
[[nodiscard]] DecodeStatus decode_set_controller_mode(std::uint8_t node, const CanFrame& frame,
                                                      std::uint32_t& control, std::uint32_t& input) noexcept;
[[nodiscard]] DecodeStatus decode_input_torque(std::uint8_t node, const CanFrame& frame,
                                               double& torque_Nm) noexcept;
[[nodiscard]] DecodeStatus decode_input_position(std::uint8_t node, const CanFrame& frame,
                                                 OdriveInputPosition& input) noexcept;
[[nodiscard]] DecodeStatus decode_parameter_request(std::uint8_t node, const CanFrame& frame,
                                                    OdriveParameter& parameter) noexcept;

}  // namespace stilt::hal::odrive
