#include "hal/vectornav/vectornav.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "hal/can/bytes.h"

namespace stilt::hal::vectornav {
namespace {

constexpr std::uint8_t kSync = 0xfa;
constexpr std::uint8_t kMoreGroups = 0x80;  // groups 8 and later follow: none that this reads
constexpr std::size_t kGroups = 7, kFields = 16;
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kAnglesField = 3, kRatesField = 5;  // of group 1
constexpr std::uint16_t kAnglesAndRates = 1u << kAnglesField | 1u << kRatesField;
constexpr double kRadiansPerDegree = std::numbers::pi / 180;

/// Bytes of the fields; 0: there is none. Chapter 4.3.6.
// clang-format off
constexpr std::uint8_t kLengths[kGroups][kFields] = {
    {8,  8,  8, 12, 16, 12, 24, 12, 12, 24, 20, 28,  2,  4, 8,  0},
    {8,  8,  8,  2,  8,  8,  8,  4,  4,  1,  1,  0,  0,  0, 0,  0},
    {2, 12, 12, 12,  4,  4, 16, 12, 12, 12, 12,  2, 40,  0, 0,  0},
    {8,  8,  2,  1,  1, 24, 24, 12, 12, 12,  4,  4,  2, 28, 2, 12},
    {2, 12, 16, 36, 12, 12, 12, 12, 12, 12, 28, 24,  0,  0, 0,  0},
    {2, 24, 24, 12, 12, 12, 12, 12, 12,  4,  4, 68, 64,  0, 0,  0},
    {8,  8,  2,  1,  1, 24, 24, 12, 12, 12,  4,  4,  2, 28, 2, 12},
};
// clang-format on

/// x^16 + x^12 + x^5 + 1, starting from 0.
std::uint16_t crc(std::span<const std::uint8_t> bytes) noexcept {
  std::uint16_t value = 0;
  for (const std::uint8_t byte : bytes) {
    value = static_cast<std::uint16_t>(value ^ byte << 8);
    for (int bit = 0; bit < 8; ++bit) {
      const bool top = (value & 0x8000) != 0;
      value = static_cast<std::uint16_t>(value << 1 ^ (top ? 0x1021 : 0));
    }
  }
  return value;
}

/// Where the parts of a message are.
struct Layout {
  std::size_t bytes = 0;      ///< of the whole message
  std::size_t angles_at = 0;  ///< 0: not in it
  std::size_t rates_at = 0;
};

enum class Header : std::uint8_t { whole, unfinished, impossible };

Header read_header(std::span<const std::uint8_t> bytes, Layout& layout) noexcept {
  if (bytes[0] != kSync) return Header::impossible;
  if (bytes.size() < 2) return Header::unfinished;
  const std::uint8_t groups = bytes[1];
  if (groups == 0 || (groups & kMoreGroups) != 0) return Header::impossible;
  std::size_t header = 2;
  for (std::size_t group = 0; group < kGroups; ++group) header += (groups >> group & 1) != 0 ? 2 : 0;
  if (bytes.size() < header) return Header::unfinished;
  std::size_t fields_at = 2;
  layout.bytes = header;
  for (std::size_t group = 0; group < kGroups; ++group) {
    if ((groups >> group & 1) == 0) continue;
    const std::uint64_t fields = load_little(bytes.subspan(fields_at, 2));
    fields_at += 2;
    for (std::size_t field = 0; field < kFields; ++field) {
      if ((fields >> field & 1) == 0) continue;
      if (kLengths[group][field] == 0) return Header::impossible;
      if (group == 0 && field == kAnglesField) layout.angles_at = layout.bytes;
      if (group == 0 && field == kRatesField) layout.rates_at = layout.bytes;
      layout.bytes += kLengths[group][field];
    }
  }
  layout.bytes += kCrcBytes;
  return layout.bytes > Stream::kLongestPacket ? Header::impossible : Header::whole;
}

double value_at(std::span<const std::uint8_t> message, std::size_t at, std::size_t number) noexcept {
  return load_float(message.subspan(at + 4 * number, 4));
}

/// Nothing when a value is no number.
std::optional<Packet> values_of(std::span<const std::uint8_t> message, const Layout& layout) noexcept {
  Packet packet;
  packet.yaw_deg = value_at(message, layout.angles_at, 0);
  packet.pitch_deg = value_at(message, layout.angles_at, 1);
  packet.roll_deg = value_at(message, layout.angles_at, 2);
  bool finite =
      std::isfinite(packet.yaw_deg) && std::isfinite(packet.pitch_deg) && std::isfinite(packet.roll_deg);
  for (std::size_t axis = 0; layout.rates_at != 0 && axis < packet.rate_rad_s.size(); ++axis) {
    packet.rate_rad_s[axis] = value_at(message, layout.rates_at, axis);
    finite = finite && std::isfinite(packet.rate_rad_s[axis]);
  }
  return finite ? std::optional(packet) : std::nullopt;
}

}  // namespace

/// The torso's y points to the left, the unit's to the right.
Pitch pitch_of(const Packet& packet, const Mounting& mounting) noexcept {
  const double angle_deg = mounting.by_roll ? packet.roll_deg : -packet.pitch_deg;
  const double rate_rad_s = mounting.by_roll ? packet.rate_rad_s[0] : -packet.rate_rad_s[1];
  return {mounting.direction * kRadiansPerDegree * angle_deg + mounting.offset_rad,
          mounting.direction * rate_rad_s};
}

Packet packet_of(const Pitch& pitch, const Mounting& mounting) noexcept {
  const double angle_deg = mounting.direction * (pitch.angle_rad - mounting.offset_rad) / kRadiansPerDegree;
  const double rate_rad_s = mounting.direction * pitch.rate_rad_s;
  if (mounting.by_roll) return {0, 0, angle_deg, {rate_rad_s, 0, 0}};
  return {0, -angle_deg, 0, {0, -rate_rad_s, 0}};
}

std::size_t Stream::push(std::span<const std::uint8_t> bytes) noexcept {
  const std::size_t taken = std::min(bytes.size(), kCapacity - count_);
  std::copy_n(bytes.begin(), taken, bytes_.begin() + static_cast<std::ptrdiff_t>(count_));
  count_ += taken;
  return taken;
}

void Stream::drop(std::size_t count) noexcept {
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(count),
            bytes_.begin() + static_cast<std::ptrdiff_t>(count_), bytes_.begin());
  count_ -= count;
}

bool Stream::next(Packet& packet) noexcept {
  std::size_t begin = 0;
  bool found = false;
  while (begin < count_ && !found) {
    const auto rest = std::span<const std::uint8_t>(bytes_).first(count_).subspan(begin);
    Layout layout;
    const Header header = read_header(rest, layout);
    if (header == Header::unfinished || (header == Header::whole && rest.size() < layout.bytes)) break;
    if (header == Header::impossible) {
      ++begin;
      ++skipped_;
      continue;
    }
    const auto message = rest.first(layout.bytes);
    if (crc(message.subspan(1)) != 0) {  // over the checksum too
      ++malformed_;
      ++begin;
      ++skipped_;
      continue;
    }
    begin += layout.bytes;
    if (layout.angles_at == 0) continue;
    const std::optional<Packet> values = values_of(message, layout);
    if (!values) ++malformed_;
    found = values.has_value();
    if (found) packet = *values;
  }
  drop(begin);
  return found;
}

std::array<std::uint8_t, kPacketBytes> encode(const Packet& packet) noexcept {
  std::array<std::uint8_t, kPacketBytes> message{};
  const std::span bytes(message);
  message[0] = kSync;
  message[1] = 1;
  store_little(bytes.subspan(2, 2), kAnglesAndRates);
  const std::array<double, 6> values{packet.yaw_deg,       packet.pitch_deg,     packet.roll_deg,
                                     packet.rate_rad_s[0], packet.rate_rad_s[1], packet.rate_rad_s[2]};
  for (std::size_t i = 0; i < values.size(); ++i)
    store_float(bytes.subspan(4 + 4 * i, 4), static_cast<float>(values[i]));
  const std::uint16_t check = crc(bytes.subspan(1, kPacketBytes - 1 - kCrcBytes));
  message[kPacketBytes - 2] = static_cast<std::uint8_t>(check >> 8);
  message[kPacketBytes - 1] = static_cast<std::uint8_t>(check & 0xff);
  return message;
}

}  // namespace stilt::hal::vectornav
