#include "hal/sensors/torso_sensor_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "hal/can/bytes.h"

namespace stilt::hal {
namespace {

std::size_t touched_bytes(const ChannelRow& row) noexcept {
  return (static_cast<std::size_t>(row.bits) + row.bit_offset + 7) / 8;
}

std::size_t end_byte(const ChannelRow& row) noexcept { return row.byte_offset + touched_bytes(row); }

std::uint64_t field_mask(const ChannelRow& row) noexcept { return (std::uint64_t{1} << row.bits) - 1; }

/// The touched bytes as one number, least significant bit of the field at bit_offset.
std::uint64_t gather(const ChannelRow& row, const CanFrame& frame) noexcept {
  const std::size_t count = touched_bytes(row);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t index = row.order == ByteOrder::little ? count - 1 - i : i;
    bits = bits << 8 | frame.data[row.byte_offset + index];
  }
  return bits;
}

void scatter(const ChannelRow& row, std::uint64_t bits, CanFrame& frame) noexcept {
  const std::size_t count = touched_bytes(row);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t index = row.order == ByteOrder::little ? i : count - 1 - i;
    frame.data[row.byte_offset + index] = static_cast<std::uint8_t>(bits & 0xff);
    bits >>= 8;
  }
}

double number_of(const ChannelRow& row, std::uint64_t raw) noexcept {
  switch (row.type) {
    case RawType::unsigned_integer:
      return static_cast<double>(raw);
    case RawType::signed_integer:
      return static_cast<double>(sign_extend(raw, row.bits));
    case RawType::float32:
      return std::bit_cast<float>(static_cast<std::uint32_t>(raw));
  }
  return 0;
}

bool same_frame(const ChannelRow& row, const CanFrame& frame) noexcept {
  return row.id == frame.id && row.extended == frame.extended;
}

/// One row of a frame it belongs to.
DecodeStatus decode_row(const ChannelRow& row, const CanFrame& frame, ChannelValues& values) noexcept {
  if (!valid(row) || end_byte(row) > frame.length) return DecodeStatus::wrong_length;
  const std::uint64_t raw = gather(row, frame) >> row.bit_offset & field_mask(row);
  if (row.has_invalid && raw == row.invalid_bits) return DecodeStatus::ok;
  const double value = row.scale * number_of(row, raw) + row.offset;
  if (!std::isfinite(value)) return DecodeStatus::not_finite;
  const auto index = static_cast<std::size_t>(row.channel);
  values.value[index] = value;
  values.present |= 1u << index;
  return DecodeStatus::ok;
}

std::uint64_t integer_bits(const ChannelRow& row, double raw, bool& saturated) noexcept {
  const double span = static_cast<double>(field_mask(row));
  const bool is_signed = row.type == RawType::signed_integer;
  const double lowest = is_signed ? -(span + 1) / 2 : 0;
  const double highest = is_signed ? (span - 1) / 2 : span;
  const double rounded = std::round(raw);
  const double limited = std::clamp(rounded, lowest, highest);
  saturated = limited != rounded;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(limited)) & field_mask(row);
}

}  // namespace

const char* name(BaseChannel channel) noexcept {
  constexpr std::array<const char*, kBaseChannels> kNames{
      "pitch_rad",         "pitch_rate_rad_s",   "acceleration_x_m_s2",    "acceleration_z_m_s2",
      "left_foot_force_N", "right_foot_force_N", "emergency_stop_released"};
  const auto index = static_cast<std::size_t>(channel);
  return index < kNames.size() ? kNames[index] : "unknown";
}

bool valid(const ChannelRow& row) noexcept {
  return row.id <= (row.extended ? kMaximumExtendedId : kMaximumStandardId) && row.bit_offset <= 7 &&
         row.bits >= 1 && row.bits <= 32 && (row.type != RawType::float32 || row.bits == 32) &&
         end_byte(row) <= kMaximumFrameBytes && std::isfinite(row.scale) && row.scale != 0 &&
         std::isfinite(row.offset) && static_cast<std::size_t>(row.channel) < kBaseChannels;
}

bool overlap(const ChannelRow& first, const ChannelRow& second) noexcept {
  if (first.id != second.id || first.extended != second.extended) return false;
  CanFrame bits_of_first, bits_of_second;
  scatter(first, field_mask(first) << first.bit_offset, bits_of_first);
  scatter(second, field_mask(second) << second.bit_offset, bits_of_second);
  for (std::size_t i = 0; i < kMaximumFrameBytes; ++i) {
    if ((bits_of_first.data[i] & bits_of_second.data[i]) != 0) return true;
  }
  return false;
}

DecodeStatus decode(std::span<const ChannelRow> table, const CanFrame& frame,
                    ChannelValues& values) noexcept {
  if (frame.remote || frame.error || frame.length > frame.data.size()) return DecodeStatus::not_addressed;
  ChannelValues found;
  bool ours = false;
  for (const ChannelRow& row : table) {
    if (!same_frame(row, frame)) continue;
    ours = true;
    const DecodeStatus status = decode_row(row, frame, found);
    if (status != DecodeStatus::ok) return status;
  }
  if (!ours) return DecodeStatus::not_addressed;
  values = found;
  return DecodeStatus::ok;
}

EncodeStatus encode(const ChannelRow& row, double value, CanFrame& frame) noexcept {
  if (!valid(row) || end_byte(row) > frame.length) return EncodeStatus::invalid;
  if (!std::isfinite(value)) return EncodeStatus::not_finite;
  const double raw = (value - row.offset) / row.scale;
  bool saturated = false;
  std::uint64_t bits = 0;
  if (row.type == RawType::float32) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    saturated = std::abs(raw) > kLargest;
    bits = std::bit_cast<std::uint32_t>(static_cast<float>(std::clamp(raw, -kLargest, kLargest)));
  } else {
    bits = integer_bits(row, raw, saturated);
  }
  const std::uint64_t mask = field_mask(row) << row.bit_offset;
  scatter(row, (gather(row, frame) & ~mask) | bits << row.bit_offset, frame);
  return saturated ? EncodeStatus::saturated : EncodeStatus::ok;
}

}  // namespace stilt::hal
