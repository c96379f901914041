#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/can/codec_status.h"
#include "hal/can/frame.h"

/// Sensors of the torso have no common protocol, so a table says which bits of which frame are which channel:
///
///   value = scale * raw + offset
///
/// Real-time safe, without state.
namespace stilt::hal {

/// Quantities that a field of a frame can hold.
enum class BaseChannel : std::uint8_t {
  pitch_rad,
  pitch_rate_rad_s,
  acceleration_x_m_s2,
  acceleration_z_m_s2,
  left_foot_force_N,
  right_foot_force_N,
  emergency_stop_released,  ///< nonzero while the switch is released
};
inline constexpr std::size_t kBaseChannels = 7;
[[nodiscard]] const char* name(BaseChannel channel) noexcept;

enum class RawType : std::uint8_t { unsigned_integer, signed_integer, float32 };

/// Little: bit 0 is the least significant bit of byte `byte_offset`, shifted by bit_offset, and the field
/// grows into later bytes (Intel). Big: the field ends bit_offset bits above the least significant bit of
/// byte byte_offset + (bits + bit_offset - 1) / 8 and grows into earlier bytes (Motorola).
enum class ByteOrder : std::uint8_t { little, big };

/// One channel. One frame may carry several.
struct ChannelRow {
  std::uint32_t id = 0;
  bool extended = false;
  std::uint8_t byte_offset = 0;  ///< first byte the field touches
  std::uint8_t bit_offset = 0;   ///< 0 to 7
  std::uint8_t bits = 16;        ///< 1 to 32; 32 for float32
  ByteOrder order = ByteOrder::little;
  RawType type = RawType::signed_integer;
  double scale = 1;
  double offset = 0;
  bool has_invalid = false;        ///< the sensor marks missing values
  std::uint32_t invalid_bits = 0;  ///< with these raw bits
  BaseChannel channel = BaseChannel::pitch_rad;
};

/// Values of one frame: one bit per channel marks those present.
struct ChannelValues {
  std::array<double, kBaseChannels> value{};
  std::uint32_t present = 0;

  [[nodiscard]] constexpr bool has(BaseChannel channel) const noexcept {
    return (present >> static_cast<unsigned>(channel) & 1u) != 0;
  }
  [[nodiscard]] constexpr double operator[](BaseChannel channel) const noexcept {
    return value[static_cast<std::size_t>(channel)];
  }
};

/// Identifier in range, field inside 64 bytes, 1 to 32 bits (32 for a float), scale finite and not 0, offset
/// finite.
[[nodiscard]] bool valid(const ChannelRow& row) noexcept;

/// Whether both are of one frame and share bits of it.
[[nodiscard]] bool overlap(const ChannelRow& first, const ChannelRow& second) noexcept;

/// All channels the table finds in a frame, whole or not at all.
/// not_addressed: no row has this identifier. wrong_length: a field lies beyond the frame. not_finite: a
/// float is NaN, infinite, or overflows when scaled. A value marked invalid by the sensor is just not
/// present.
[[nodiscard]] DecodeStatus decode(std::span<const ChannelRow> table, const CanFrame& frame,
                                  ChannelValues& values) noexcept;

/// Writes a channel into a frame that is long enough (emulated sensors, tests). saturated: beyond the field's
/// range.
[[nodiscard]] EncodeStatus encode(const ChannelRow& row, double value, CanFrame& frame) noexcept;

}  // namespace stilt::hal
