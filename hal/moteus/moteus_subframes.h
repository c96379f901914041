#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/can/codec_status.h"
#include "hal/can/frame.h"

/// The layer of moteus frames below any meaning. A frame is a list of subframes, each of which writes, reads
/// or reports a run of registers in one of four resolutions. Bytes:
///
///   kind and resolution | number of registers (in the low two bits when 1 to 3) | first register | values
///   write 00 04 08 0c, read 10 14 18 1c, reply 20 24 28 2c (int8, int16, int32, float), error 30 31, padding
///   50
///
/// or it carries bytes of a stream: 40 to the driver, 41 from it, 42 asks for some. Then come channel, number
/// of bytes, and with 40 and 41 the bytes. Channel 1 is the driver's command line.
///
/// Numbers are variable-length unsigned integers (7 bits per byte, least significant first, at most 5 bytes),
/// values little endian. Facts: github.com/mjbots/moteus, docs/protocol/can.md and
/// docs/protocol/registers.md. Real-time safe.
namespace stilt::hal::moteus {

/// Numbers of the registers that are read or written.
enum class MoteusRegister : std::uint16_t {
  mode = 0x000,
  position = 0x001,
  velocity = 0x002,
  torque = 0x003,
  motor_temperature = 0x00a,
  home_state = 0x00c,
  voltage = 0x00d,
  temperature = 0x00e,
  fault = 0x00f,
  command_position = 0x020,
  command_velocity = 0x021,
  command_torque = 0x022,
  command_kp_scale = 0x023,
  command_kd_scale = 0x024,
  command_maximum_torque = 0x025,
  command_stop_position = 0x026,
  command_timeout = 0x027,
  command_velocity_limit = 0x028,
  command_accel_limit = 0x029,
  proportional = 0x030,  ///< of the torque; then integral and derivative
  integral = 0x031,
  derivative = 0x032,
  control_position = 0x038,
  position_error = 0x03b,  ///< sensed minus control; then that of the velocity
  velocity_error = 0x03c,
  encoder_0_position = 0x050,  ///< then velocity of encoder 0, position of encoder 1, ... to 0x055
  model = 0x100,
  firmware_version = 0x101,  ///< 0x010304 is 1.3.4
  register_map_version = 0x102,
};

enum class Resolution : std::uint8_t { int8, int16, int32, real };

[[nodiscard]] constexpr std::size_t bytes_of(Resolution resolution) noexcept {
  return resolution == Resolution::int8 ? 1 : resolution == Resolution::int16 ? 2 : 4;
}

/// Value of one least significant bit of a register; 1 for registers that are plain numbers.
[[nodiscard]] double unit_of(std::uint32_t register_number, Resolution resolution) noexcept;

/// Whether the register is a plain number (mode, fault, version): no NaN, no scale.
[[nodiscard]] bool is_plain(std::uint32_t register_number) noexcept;

/// What a subframe asks for or answers.
enum class SubframeKind : std::uint8_t {
  write,
  read,
  reply,
  write_error,
  read_error,
  stream_in,   ///< to the driver
  stream_out,  ///< from the driver
  stream_poll,
};

/// Head of a subframe, its values follow.
struct Subframe {
  SubframeKind kind = SubframeKind::read;
  Resolution resolution = Resolution::int8;
  std::uint32_t start = 0;  ///< first register; of an error: the register; of a stream: its channel
  std::uint32_t count =
      0;  ///< registers; of an error: its number; of a stream: bytes, or most that are wanted
  /// Count values, little endian, or bytes of a stream; empty for reads, polls and errors.
  std::span<const std::uint8_t> values;
};

/// Value i of a write or reply in the register's unit; the most negative integer of a scaled register is NaN.
/// The reader has checked that i < count values are there.
[[nodiscard]] double value_of(const Subframe& subframe, std::uint32_t i) noexcept;

/// Walks through the subframes of a payload.
class SubframeReader {
 public:
  explicit SubframeReader(std::span<const std::uint8_t> payload) noexcept : rest_(payload) {}

  /// Next subframe; false at the end and at the first inconsistency: see status().
  [[nodiscard]] bool next(Subframe& subframe) noexcept;

  /// ok, or malformed: next() found a type that does not exist, or a count of zero or beyond any frame. Or
  /// a register beyond 16 bits, or a subframe that is cut off.
  [[nodiscard]] DecodeStatus status() const noexcept { return status_; }

 private:
  [[nodiscard]] bool take_number(std::uint32_t& number) noexcept;
  [[nodiscard]] bool take_values(std::size_t size, Subframe& subframe) noexcept;
  [[nodiscard]] bool next_registers(std::uint8_t head, Subframe& subframe) noexcept;
  [[nodiscard]] bool next_stream(std::uint8_t head, Subframe& subframe) noexcept;
  [[nodiscard]] bool fail() noexcept;

  std::span<const std::uint8_t> rest_;
  DecodeStatus status_ = DecodeStatus::ok;
};

/// Appends subframes to a frame. After no_room the frame is of no use.
class SubframeWriter {
 public:
  explicit SubframeWriter(CanFrame& frame) noexcept : frame_(frame) {}

  /// Writes (or, for the driver's side, replies) values of consecutive registers, in the registers' units;
  /// NaN is "unset". Values beyond the resolution saturate.
  void values(SubframeKind kind, MoteusRegister start, Resolution resolution,
              std::span<const double> values) noexcept;
  void read(MoteusRegister start, Resolution resolution, std::uint32_t count) noexcept;

  /// Bytes of a stream (stream_in, stream_out), or a poll for at most `count` of them.
  void stream(SubframeKind kind, std::uint32_t channel, std::span<const std::uint8_t> bytes) noexcept;
  void poll_stream(std::uint32_t channel, std::uint32_t count) noexcept;

  /// Pads to the next length of a CAN FD frame and sets it.
  [[nodiscard]] EncodeStatus finish() noexcept;

 private:
  void header(std::uint8_t type, std::uint32_t start, Resolution resolution, std::uint32_t count) noexcept;
  void number(std::uint32_t value) noexcept;
  void byte(std::uint8_t value) noexcept;

  CanFrame& frame_;
  std::size_t size_ = 0;
  bool saturated_ = false;
  bool overflow_ = false;
};

}  // namespace stilt::hal::moteus
