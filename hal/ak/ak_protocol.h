#pragma once

#include <cstdint>

#include "hal/can/codec_status.h"
#include "hal/can/frame.h"
#include "hal/driver/driver_fault.h"

/// CubeMars AK motors with driver boards of version 3. All frames are classic, extended and most significant
/// byte first; identifier = what << 8 | identifier of the driver. A command of force control carries two
/// gains, position, velocity and a torque; the driver computes at its output
///
///   tau = kp (position - q) + kd (velocity - v) + torque
///
/// Its bits, in this order: kp 12, kd 12, position 16, velocity 12, torque 12. A value x of range [a, b] in n
/// bits is the integer part of (x - a) (2^n - 1) / (b - a). Sources disagree whether 2^n takes the place of
/// 2^n - 1; the manual's example of a velocity has 0 as 0x7fff and 0x7ff, which is 2^n - 1. What arrives is
/// at most one step off.
///
/// It answers nothing. By its own clock, 1 to 500 times per second, it sends
///
///   status 0x29    position int16, 0.1 degrees of the output; speed int16, 10 rpm of the electrical field;
///                  current int16, 0.01 A; temperature of the driver int8, C; error uint8
///   position 0x2a  where it is switched on: int32, 0.01 degrees
///   start 0x2c     once after power-up: FA FB FC FD
///
///   velocity of the output = electrical speed / pole pairs / gear ratio
///
/// It has no frames to enable, disable and zero as version 2 has. It would read those as a command of the
/// largest gains and torque. It is always on, and follows its last command for ever. It takes missing bytes
/// of a command for zeros, so that a short one asks for the lower end of the position.
///
/// Facts: AK Series Module Product Manual 3.0.0 to 3.2.0, sections 4.1 to 4.4, as quoted by public users of
/// it. These are ak_v3_driver (protocol.hpp, test_protocol.cpp), AK_V3_CAN.py, a chapter on the manual's
/// examples, and an audit of torque paths of an AK60-6. Real-time safe, without state.
namespace stilt::hal::ak {

inline constexpr double kAkPosition_rad = 12.56;   ///< either way, of every model
inline constexpr double kAkKp_Nm_rad = 500;        ///< of every model
inline constexpr double kAkKd_Nms_rad = 5;         ///< of every model
inline constexpr double kAkGainStep = 1.0 / 4095;  ///< of the field of a gain, as a share of its range
inline constexpr double kAkMost_hz = 500;          ///< its fastest reports
inline constexpr double kAkStatusStep_rad = 0.1 * 0.017453292519943295;
inline constexpr double kAkPositionStep_rad = 0.01 * 0.017453292519943295;

/// What is asked of a driver.
enum class AkMode : std::uint8_t {
  set_origin = 5,     ///< 1 byte: 0 until power is gone, 1 also in flash
  force_control = 8,  ///< 8 bytes
  disable = 15,       ///< no byte; manual 3.2.0. Older firmware may not have it, so that we never send it
  set_feedback = 16,  ///< 8 bytes, writes to flash; manual 3.2.0: bit 15 of the last two position frames,
                      ///< bit 14 one turn
};

enum class AkReport : std::uint8_t { status = 0x29, position = 0x2a, start = 0x2c };

/// One driver. Ranges are from minus this to plus this, gains from 0.
struct AkDriver {
  std::uint8_t id = 104;
  double position_rad = kAkPosition_rad;
  double velocity_rad_s = 65;  ///< of the model: 65 rad/s of an AK80-9
  double kp_Nm_rad = kAkKp_Nm_rad;
  double kd_Nms_rad = kAkKd_Nms_rad;
  double torque_Nm = 18;               ///< of the model: 18 Nm of an AK80-9
  double status_rate_hz = kAkMost_hz;  ///< as set in the driver
  bool position_frames = false;        ///< it sends them, too
  int pole_pairs = 21;                 ///< of an AK80-9
  double gear_ratio = 9;               ///< inside the motor
  /// Torque of the output per reported current; 0: no torque is read from it. Sources disagree whether the
  /// current's sign is that of the torque, or that of driving and braking.
  double torque_constant_Nm_A = 0;
};

/// A command in MIT mode, at the motor's output shaft.
struct AkCommand {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double kp_Nm_rad = 0;
  double kd_Nms_rad = 0;
  double torque_Nm = 0;
};

/// A command as its bits.
struct AkCodes {
  std::uint16_t kp = 0;
  std::uint16_t kd = 0;
  std::uint16_t position = 0;
  std::uint16_t velocity = 0;
  std::uint16_t torque = 0;
  friend bool operator==(const AkCodes&, const AkCodes&) = default;
};

/// What a status frame holds, at the motor's output shaft.
struct AkStatus {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double current_A = 0;
  double driver_temperature_C = 0;
  std::uint8_t code = 0;  ///< as sent
  DriverFault fault = DriverFault::none;
  bool disabled = false;  ///< confirms AkMode::disable: code 0x77, once
};

[[nodiscard]] constexpr std::uint32_t ak_id(AkMode mode, std::uint8_t id) noexcept {
  return static_cast<std::uint32_t>(mode) << 8 | id;
}
[[nodiscard]] constexpr std::uint32_t ak_id(AkReport report, std::uint8_t id) noexcept {
  return static_cast<std::uint32_t>(report) << 8 | id;
}

/// Ranges, rate, pole pairs and gear ratio positive and finite.
[[nodiscard]] bool valid(const AkDriver& driver) noexcept;

[[nodiscard]] EncodeStatus encode_command(const AkDriver& driver, const AkCommand& command,
                                          CanFrame& frame) noexcept;
/// No gain and no torque: the motor is free. It must be sent again and again, as any command.
[[nodiscard]] EncodeStatus encode_limp(const AkDriver& driver, CanFrame& frame) noexcept;
/// The present position becomes zero. A command that is held counts from there, too: send a limp one before.
[[nodiscard]] CanFrame origin_frame(const AkDriver& driver, bool in_flash) noexcept;

[[nodiscard]] DecodeStatus decode_status(const AkDriver& driver, const CanFrame& frame,
                                         AkStatus& status) noexcept;
/// 4 bytes, or more as some firmware sends.
[[nodiscard]] DecodeStatus decode_position(const AkDriver& driver, const CanFrame& frame,
                                           double& position_rad) noexcept;
[[nodiscard]] bool is_start(const AkDriver& driver, const CanFrame& frame) noexcept;

// The driver's side: for emulated drivers and tests.

/// As the driver reads it: bytes that are missing are zeros.
[[nodiscard]] DecodeStatus decode_codes(std::uint8_t id, const CanFrame& frame, AkCodes& codes) noexcept;
/// @param whole_scale  2^n in the place of 2^n - 1
[[nodiscard]] AkCommand command_of(const AkDriver& driver, const AkCodes& codes, bool whole_scale) noexcept;
/// No gain, and a torque that is 0 by either scale.
[[nodiscard]] constexpr bool limp(const AkCodes& codes) noexcept {
  return codes.kp == 0 && codes.kd == 0 && (codes.torque == 0x7ff || codes.torque == 0x800);
}
/// wrong_length: not 8 bytes.
[[nodiscard]] DecodeStatus decode_command(const AkDriver& driver, const CanFrame& frame,
                                          AkCommand& command) noexcept;
/// Values beyond their fields saturate; the integer part counts.
[[nodiscard]] EncodeStatus encode_status(const AkDriver& driver, const AkStatus& status,
                                         CanFrame& frame) noexcept;
/// @param length  4 or 8
[[nodiscard]] EncodeStatus encode_position(const AkDriver& driver, double position_rad, std::uint8_t length,
                                           CanFrame& frame) noexcept;
[[nodiscard]] CanFrame start_frame(const AkDriver& driver) noexcept;
/// Number of a fault; 7 for those that it has no number for.
[[nodiscard]] std::uint8_t ak_code(DriverFault fault) noexcept;

}  // namespace stilt::hal::ak
