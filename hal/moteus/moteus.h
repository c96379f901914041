#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <numbers>

#include "hal/can/codec_status.h"
#include "hal/can/frame.h"
#include "hal/driver/driver_fault.h"
#include "hal/moteus/moteus_subframes.h"

/// moteus over CAN FD (1 and 5 Mbit/s). Identifier = source << 8 | destination; the top bit of the source
/// asks for a reply; extended beyond 11 bits. The driver computes, in position mode,
///
///   tau = kp_scale kp (position - q) + kd_scale kd (velocity - v) + torque, |tau| <= maximum torque
///
/// with kp and kd from its own configuration, so both are data here. Each command restarts the driver's
/// watchdog. When that expires the driver latches mode `timeout`, damps with the newest command's kd scale
/// (servo.timeout_mode 12), and accepts nothing but a stop. It does not damp after a command without kd.
/// A frame is answered from the state before it: what it writes takes effect afterwards. Without limits in
/// the command the driver follows position and velocity by a trajectory of its own
/// (servo.default_accel_limit, 50 rev/s^2 from firmware 1.0.0 on). That cancels damping. Every command here
/// switches that off. Facts: github.com/mjbots/moteus, docs/protocol/can.md, docs/protocol/registers.md,
/// docs/reference/configuration.md, fw/moteus_controller.cc, fw/bldc_servo_position.h (db1a762). Real-time
/// safe, without state.
namespace stilt::hal::moteus {

inline constexpr std::uint8_t kMoteusMaximumId = 0x7e;  ///< 0x7f is for all
inline constexpr std::uint8_t kMoteusEncoders = 3;
inline constexpr std::uint32_t kMoteusRegisterMap = 5;  ///< version of the scales that are used here
/// Ends of a command's int16, at the shaft.
inline constexpr double kMoteusPosition_rad = 3.2767 * 2 * std::numbers::pi;
inline constexpr double kMoteusVelocity_rad_s = 8.19175 * 2 * std::numbers::pi;
inline constexpr double kMoteusTorque_Nm = 327.67;
inline constexpr double kScaleStep = 1.0 / 32767;  ///< of the scale of a gain in a command, int16

/// Modes that matter here, by register 0x000; others exist.
enum class MoteusMode : std::uint8_t {
  stopped = 0,
  fault = 1,
  enabling = 2,
  calibrating = 3,
  calibrated = 4,
  position = 10,
  timeout = 11,
  zero_velocity = 12,  ///< damps with the driver's own kd
};

/// What a position is relative to, by register 0x00c.
enum class MoteusHome : std::uint8_t { relative = 0, rotor = 1, output = 2 };

/// A driver and how it is addressed.
struct MoteusDriver {
  std::uint8_t id = 1;      ///< 1 to 126
  std::uint8_t source = 0;  ///< ours, 0 to 127
  bool bit_rate_switch = true;
  double kp_Nm_rev = 4.0;     ///< servo.pid_position.kp: gain at kp_scale 1, Nm per revolution
  double kd_Nm_s_rev = 0.05;  ///< servo.pid_position.kd: gain at kd_scale 1, Nm per revolution per second
  int extra_encoder = -1;     ///< 0 to 2: also ask for this encoder (one at the torso, say); -1: none
};

/// Unset (NaN): position_rad - stay at the present one; maximum_torque_Nm - the driver's own limit.
struct MoteusCommand {
  double position_rad = std::numeric_limits<double>::quiet_NaN();
  double velocity_rad_s = 0;
  double torque_Nm = 0;
  double kp_Nm_rad = 0;
  double kd_Nms_rad = 0;
  double maximum_torque_Nm = std::numeric_limits<double>::quiet_NaN();
  double watchdog_s = 0.02;  ///< validity of this command, in steps of 1 ms; at least one step
};

/// What a reply reported; values it did not contain are NaN, or absent from `has`.
struct MoteusReply {
  double position_rad = std::numeric_limits<double>::quiet_NaN();
  double velocity_rad_s = std::numeric_limits<double>::quiet_NaN();
  double torque_Nm = std::numeric_limits<double>::quiet_NaN();
  double voltage_V = std::numeric_limits<double>::quiet_NaN();
  double temperature_C = std::numeric_limits<double>::quiet_NaN();
  double motor_temperature_C = std::numeric_limits<double>::quiet_NaN();
  std::array<double, kMoteusEncoders> encoder_position_rad{std::numeric_limits<double>::quiet_NaN(),
                                                           std::numeric_limits<double>::quiet_NaN(),
                                                           std::numeric_limits<double>::quiet_NaN()};
  std::array<double, kMoteusEncoders> encoder_velocity_rad_s{std::numeric_limits<double>::quiet_NaN(),
                                                             std::numeric_limits<double>::quiet_NaN(),
                                                             std::numeric_limits<double>::quiet_NaN()};
  bool has_mode = false;
  bool has_fault = false;
  bool has_home = false;
  bool has_firmware_version = false;
  bool has_register_map_version = false;
  bool has_control = false;     ///< the five values of MoteusQuery::control
  bool register_error = false;  ///< the driver refused to read or write a register
  std::uint8_t mode = 0;        ///< MoteusMode, or another number of the reference
  std::uint8_t fault_code = 0;
  std::uint8_t home = 0;  ///< MoteusHome
  std::uint32_t firmware_version = 0;
  std::uint32_t register_map_version = 0;
  double watchdog_s = std::numeric_limits<double>::quiet_NaN();
  double control_position_rad = std::numeric_limits<double>::quiet_NaN();  ///< that the driver holds to
  double position_error_rad = std::numeric_limits<double>::quiet_NaN();    ///< sensed minus control
  double velocity_error_rad_s = std::numeric_limits<double>::quiet_NaN();
  double proportional_Nm = std::numeric_limits<double>::quiet_NaN();  ///< kp_scale kp position error
  double integral_Nm = std::numeric_limits<double>::quiet_NaN();
  double derivative_Nm = std::numeric_limits<double>::quiet_NaN();  ///< kd_scale kd velocity error
};

/// What to ask for beside a stop or alone.
enum class MoteusQuery : std::uint8_t {
  state,            ///< mode, position, velocity, torque, voltage, temperature, fault
  state_and_motor,  ///< and the temperature of the motor
  identity,         ///< mode, home state, fault, firmware and register map version, watchdog
  control,          ///< mode, fault, terms of the torque before its limit, control position and errors
};

[[nodiscard]] bool valid(const MoteusDriver& driver) noexcept;

/// An empty CAN FD frame to the driver that asks for a reply.
[[nodiscard]] CanFrame frame_to(const MoteusDriver& driver) noexcept;
/// Whether a frame is the driver's reply.
[[nodiscard]] bool is_reply_of(const MoteusDriver& driver, const CanFrame& frame) noexcept;
/// Whether a frame is to the driver, and an empty frame from it that answers this one: the driver's side.
[[nodiscard]] bool is_frame_to(const MoteusDriver& driver, const CanFrame& frame) noexcept;
[[nodiscard]] CanFrame answer_to(const MoteusDriver& driver, const CanFrame& frame) noexcept;

/// Number of the reference -> common name. Codes from 96 name what limits the output: no fault.
[[nodiscard]] DriverFault moteus_fault(std::uint8_t code) noexcept;

/// Position mode without a limit of the acceleration, and a query. With one of the state (and the extra
/// encoder) the frame has 32 bytes, answered with 24 (48 with encoder). With the motor's temperature these
/// are 48 and 32 (48). Position, velocity, torque, gains and limit are int16: 0.63 mrad, 1.6 mrad/s, 0.01 Nm,
/// 1/32767; within kMoteusPosition_rad and kMoteusVelocity_rad_s.
[[nodiscard]] EncodeStatus encode_command(const MoteusDriver& driver, const MoteusCommand& command,
                                          CanFrame& frame, MoteusQuery query = MoteusQuery::state) noexcept;
/// Stop: motor off, faults and an expired watchdog cleared.
[[nodiscard]] EncodeStatus encode_stop(const MoteusDriver& driver, MoteusQuery query,
                                       CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode_query(const MoteusDriver& driver, MoteusQuery query,
                                        CanFrame& frame) noexcept;
/// Writes the watchdog register alone, to be read back: seconds, steps of 1 ms.
[[nodiscard]] EncodeStatus encode_watchdog(const MoteusDriver& driver, double watchdog_s,
                                           CanFrame& frame) noexcept;

/// Bytes of the driver's command line beside the registers are no error, and change nothing.
[[nodiscard]] DecodeStatus decode_reply(const MoteusDriver& driver, const CanFrame& frame,
                                        MoteusReply& reply) noexcept;

// The driver's side: for emulated drivers and tests.

/// One register of the driver as it keeps it, by number; NaN for one it does not have.
using MoteusRegisterReader = double (*)(const void* context, std::uint32_t register_number) noexcept;
using MoteusRegisterWriter = void (*)(void* context, std::uint32_t register_number, double value) noexcept;

/// Applies the writes of a frame in order, through `write`, and fills `answer` with what its reads ask for,
/// through `read`. Units are those of the registers (revolutions). answered: whether the frame asks for an
/// answer.
[[nodiscard]] DecodeStatus serve_frame(const MoteusDriver& driver, const CanFrame& frame, void* context,
                                       MoteusRegisterReader read, MoteusRegisterWriter write,
                                       CanFrame& answer, bool& answered) noexcept;

}  // namespace stilt::hal::moteus
