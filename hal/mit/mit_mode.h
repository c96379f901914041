#pragma once

#include <cstdint>
#include <limits>

#include "hal/can/codec_status.h"
#include "hal/can/frame.h"
#include "hal/driver/driver_fault.h"

/// MIT mode: one classic frame of 8 bytes carries position, velocity, two gains and a torque; the driver
/// computes
///
///   tau = kp (position - q) + kd (velocity - v) + torque
///
/// Command, most significant bit first: position 16, velocity 12, kp 12, kd 12, torque 12 bits.
/// Reply: driver identifier 8, position 16, velocity 12, torque 12 bits, then bytes that differ by vendor
/// (ReplyLayout). A value x of range [a, b] in n bits is the integer part of (x - a) (2^n - 1) / (b - a).
/// Vendors cut off instead of rounding. What arrives is up to one step below what was asked, and no code is
/// exactly zero in a symmetric range. A gain below one step arrives as 0.
///
/// Facts: B. Katz, HKC_MiniCheetah CAN_com.cpp (layout, cut-off); CubeMars AK series manual 1.0.17,
/// section 5.3 (8-byte reply, temperature = byte - 40); Damiao DM-J manuals and
/// github.com/jia-xie/python-damiao-driver, docs/concept/communication-protocol.md. The ranges of both gains
/// are fixed there, and equal in mit_can.py of github.com/neurobionics/TMotorCANControl for AK motors. Their
/// torque has one range in commands and replies. Everything here is real-time safe and keeps no state.
namespace stilt::hal::mit {

/// Ends of the gains in the firmware of every Damiao and AK. That of a mini-cheetah is rebuilt by its users.
inline constexpr double kVendorKp_Nm_rad = 500;
inline constexpr double kVendorKd_Nms_rad = 5;

/// Values that the ends of a fixed-point field stand for, in the unit of the field.
struct Range {
  double minimum;
  double maximum;
};

/// What the bytes after the torque of a reply mean.
enum class ReplyLayout : std::uint8_t {
  mini_cheetah,  ///< 6 bytes; of newer firmware 7, the last the supply voltage
  ak,            ///< 8 bytes: temperature of the driver with an offset, error number
  damiao,        ///< 8 bytes: status in the high half of byte 0; temperatures of transistors and rotor
};

/// One driver in MIT mode. Ranges belong to the firmware of the driver, not to the protocol: take them from
/// its manual or its registers. Those of the reply may differ from those of the command.
struct MitDriver {
  std::uint16_t command_id = 1;  ///< identifier of its commands
  std::uint16_t reply_id = 0;    ///< identifier it answers with
  std::uint8_t driver_id = 1;    ///< in byte 0 of its replies (Damiao: low half)
  ReplyLayout layout = ReplyLayout::mini_cheetah;
  Range position_rad{-12.5, 12.5};
  Range velocity_rad_s{-65, 65};
  Range kp_Nm_rad{0, kVendorKp_Nm_rad};
  Range kd_Nms_rad{0, kVendorKd_Nms_rad};
  Range torque_Nm{-18, 18};
  Range reply_position_rad{-12.5, 12.5};
  Range reply_velocity_rad_s{-65, 65};
  Range reply_torque_Nm{-18, 18};
  Range supply_V{0, 40};              ///< byte 6 of mini_cheetah
  double temperature_offset_C = -40;  ///< added to byte 6 of ak, which has no sign: -40 to 215 C
};

/// Bits of byte 0 of a reply that are the driver's number: several drivers may answer with one identifier.
[[nodiscard]] constexpr std::uint8_t sender_mask(const MitDriver& driver) noexcept {
  return driver.layout == ReplyLayout::damiao ? 0x0f : 0xff;
}

/// A command in MIT mode, at the motor's output shaft.
struct MitCommand {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double kp_Nm_rad = 0;
  double kd_Nms_rad = 0;
  double torque_Nm = 0;
};

/// What a reply holds, at the motor's output shaft.
struct MitReply {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double torque_Nm = 0;
  double supply_V = std::numeric_limits<double>::quiet_NaN();
  double driver_temperature_C = std::numeric_limits<double>::quiet_NaN();
  double motor_temperature_C = std::numeric_limits<double>::quiet_NaN();
  bool reports_enabled = false;  ///< layout reports whether the motor is enabled (Damiao only)
  bool enabled = false;          ///< meaningful with reports_enabled
  std::uint8_t fault_code = 0;   ///< the vendor's: byte 7 of ak, high half of byte 0 of damiao
  DriverFault fault = DriverFault::none;
};

/// Frames of seven FF and a last byte. A command whose bytes would read as one is changed by one step of kd.
enum class MitSpecial : std::uint8_t {
  clear_error = 0xfb,  ///< Damiao
  enter = 0xfc,        ///< motor on
  leave = 0xfd,        ///< motor off
  set_zero = 0xfe,     ///< present position becomes zero
};

/// Identifiers in range and every range with minimum < maximum, finite.
[[nodiscard]] bool valid(const MitDriver& driver) noexcept;

[[nodiscard]] EncodeStatus encode_command(const MitDriver& driver, const MitCommand& command,
                                          CanFrame& frame) noexcept;
[[nodiscard]] DecodeStatus decode_reply(const MitDriver& driver, const CanFrame& frame,
                                        MitReply& reply) noexcept;
[[nodiscard]] CanFrame special_frame(const MitDriver& driver, MitSpecial special) noexcept;

/// The driver's side: for emulated drivers and tests.
[[nodiscard]] DecodeStatus decode_command(const MitDriver& driver, const CanFrame& frame,
                                          MitCommand& command) noexcept;
[[nodiscard]] EncodeStatus encode_reply(const MitDriver& driver, const MitReply& reply,
                                        CanFrame& frame) noexcept;
[[nodiscard]] DecodeStatus decode_special(const MitDriver& driver, const CanFrame& frame,
                                          MitSpecial& special) noexcept;

/// An AK answers with this identifier or with its own, by its firmware.
inline constexpr std::uint16_t kAkZeroReplyId = 0;

/// Extended identifier of what an AK in servo mode sends by itself, 1 to 500 times per second. It is 0x29 and
/// the AK's identifier (CubeMars AK series manual 1.0.17, section 5.2). Then it answers no frame of MIT mode.
[[nodiscard]] constexpr std::uint32_t ak_servo_status_id(const MitDriver& driver) noexcept {
  return 0x2900u | driver.command_id;
}

/// Size of one step of an n-bit field.
[[nodiscard]] constexpr double step(const Range& range, unsigned bits) noexcept {
  return (range.maximum - range.minimum) / static_cast<double>((1u << bits) - 1);
}

}  // namespace stilt::hal::mit
