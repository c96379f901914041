#include "hal/moteus/moteus_subframes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/can/bytes.h"

namespace stilt::hal::protocol {
namespace {

constexpr std::uint8_t kTypeMask = 0xf0;
constexpr std::uint8_t kWriteType = 0x00;
constexpr std::uint8_t kReadType = 0x10;
constexpr std::uint8_t kReplyType = 0x20;
constexpr std::uint8_t kWriteError = 0x30;
constexpr std::uint8_t kReadError = 0x31;
constexpr std::uint8_t kPadding = 0x50;
constexpr std::uint32_t kMaximumRegister = 0xffff;

enum class Quantity : std::uint8_t {
  plain,
  position,
  velocity,
  torque,
  current,
  voltage,
  temperature,
  time,
  fraction,
  power,
  acceleration
};

Quantity quantity_of(std::uint32_t register_number) noexcept {
  switch (register_number) {
    case 0x001:
    case 0x006:
    case 0x020:
    case 0x026:
    case 0x038:
    case 0x03b:
    case 0x040:
    case 0x041:
    case 0x050:
    case 0x052:
    case 0x054:
    case 0x130:
    case 0x131:
      return Quantity::position;
    case 0x002:
    case 0x01e:
    case 0x021:
    case 0x028:
    case 0x039:
    case 0x03c:
    case 0x051:
    case 0x053:
    case 0x055:
      return Quantity::velocity;
    case 0x003:
    case 0x022:
    case 0x025:
    case 0x030:
    case 0x031:
    case 0x032:
    case 0x033:
    case 0x034:
    case 0x03a:
    case 0x03d:
    case 0x042:
    case 0x045:
      return Quantity::torque;
    case 0x004:
    case 0x005:
    case 0x01c:
    case 0x01d:
    case 0x02c:
      return Quantity::current;
    case 0x00d:
    case 0x014:
    case 0x015:
    case 0x016:
    case 0x019:
    case 0x01a:
    case 0x01b:
    case 0x02a:
      return Quantity::voltage;
    case 0x00a:
    case 0x00e:
      return Quantity::temperature;
    case 0x027:
    case 0x046:
      return Quantity::time;
    case 0x010:
    case 0x011:
    case 0x012:
    case 0x018:
    case 0x023:
    case 0x024:
    case 0x02b:
    case 0x043:
    case 0x044:
    case 0x047:
      return Quantity::fraction;
    case 0x007:
      return Quantity::power;
    case 0x029:
      return Quantity::acceleration;
    default:
      return Quantity::plain;
  }
}

/// Value of the least significant bit in int8, int16 and int32: docs/protocol/registers.md, "Mappings".
struct Units {
  double int8;
  double int16;
  double int32;
};

Units units_of(Quantity quantity) noexcept {
  switch (quantity) {
    case Quantity::plain:
      return {1, 1, 1};
    case Quantity::position:
      return {0.01, 0.0001, 0.00001};
    case Quantity::velocity:
      return {0.1, 0.00025, 0.00001};
    case Quantity::torque:
      return {0.5, 0.01, 0.001};
    case Quantity::current:
      return {1, 0.1, 0.001};
    case Quantity::voltage:
      return {0.5, 0.1, 0.001};
    case Quantity::temperature:
      return {1, 0.1, 0.001};
    case Quantity::time:
      return {0.01, 0.001, 0.000001};
    case Quantity::fraction:
      return {1.0 / 127, 1.0 / 32767, 1.0 / 2147483647};
    case Quantity::power:
      return {10, 0.05, 0.0001};
    case Quantity::acceleration:
      return {0.05, 0.001, 0.00001};
  }
  return {1, 1, 1};
}

/// The integer of a value; NaN becomes the most negative one.
std::int64_t integer_of(double value, double unit, Resolution resolution, bool& saturated) noexcept {
  const double top = resolution == Resolution::int8    ? 127
                     : resolution == Resolution::int16 ? 32767
                                                       : 2147483647;
  if (std::isnan(value)) return static_cast<std::int64_t>(-top - 1);
  const double scaled = value / unit;
  const double limited = std::clamp(scaled, -top, top);
  saturated = saturated || std::abs(scaled) > top + 0.5;
  return static_cast<std::int64_t>(std::round(limited));
}

float real_of(double value, bool& saturated) noexcept {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (std::isnan(value)) return std::numeric_limits<float>::quiet_NaN();
  saturated = saturated || std::abs(value) > kLargest;
  return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

}  // namespace

double unit_of(std::uint32_t register_number, Resolution resolution) noexcept {
  const Units units = units_of(quantity_of(register_number));
  switch (resolution) {
    case Resolution::int8:
      return units.int8;
    case Resolution::int16:
      return units.int16;
    case Resolution::int32:
      return units.int32;
    case Resolution::real:
      return 1;
  }
  return 1;
}

bool is_plain(std::uint32_t register_number) noexcept {
  return quantity_of(register_number) == Quantity::plain;
}

double value_of(const Subframe& subframe, std::uint32_t i) noexcept {
  const std::size_t size = bytes_of(subframe.resolution);
  const auto bytes = subframe.values.subspan(i * size, size);
  if (subframe.resolution == Resolution::real) return load_float(bytes);
  const unsigned bits = static_cast<unsigned>(8 * size);
  const std::int64_t integer = sign_extend(load_little(bytes), bits);
  const std::uint32_t register_number = subframe.start + i;
  const std::int64_t unset = -(std::int64_t{1} << (bits - 1));
  if (integer == unset && !is_plain(register_number)) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(integer) * unit_of(register_number, subframe.resolution);
}

bool SubframeReader::fail() noexcept {
  status_ = DecodeStatus::malformed;
  rest_ = {};
  return false;
}

bool SubframeReader::take_number(std::uint32_t& number) noexcept {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < 5; ++i) {
    if (rest_.empty()) return false;
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    value |= static_cast<std::uint64_t>(byte & 0x7f) << (7 * i);
    if ((byte & 0x80) == 0) {
      number = static_cast<std::uint32_t>(value);
      return value <= 0xffffffffu;
    }
  }
  return false;
}

bool SubframeReader::next(Subframe& subframe) noexcept {
  while (!rest_.empty() && rest_.front() == kPadding) rest_ = rest_.subspan(1);
  if (rest_.empty()) return false;
  const std::uint8_t head = rest_.front();
  rest_ = rest_.subspan(1);
  Subframe found;
  if (head == kWriteError || head == kReadError) {
    found.kind = head == kWriteError ? SubframeKind::write_error : SubframeKind::read_error;
    if (!take_number(found.start) || !take_number(found.count)) return fail();
    subframe = found;
    return true;
  }
  switch (head & kTypeMask) {
    case kWriteType:
      found.kind = SubframeKind::write;
      break;
    case kReadType:
      found.kind = SubframeKind::read;
      break;
    case kReplyType:
      found.kind = SubframeKind::reply;
      break;
    default:
      return fail();
  }
  found.resolution = static_cast<Resolution>(head >> 2 & 0x3);
  found.count = head & 0x3;
  if (found.count == 0 && !take_number(found.count)) return fail();
  if (!take_number(found.start)) return fail();
  if (found.count == 0 || found.count > kMaximumFrameBytes || found.start > kMaximumRegister) return fail();
  if (found.kind != SubframeKind::read) {
    const std::size_t size = found.count * bytes_of(found.resolution);
    if (size > rest_.size()) return fail();
    found.values = rest_.first(size);
    rest_ = rest_.subspan(size);
  }
  subframe = found;
  return true;
}

void SubframeWriter::byte(std::uint8_t value) noexcept {
  if (size_ == frame_.data.size()) {
    overflow_ = true;
    return;
  }
  frame_.data[size_++] = value;
}

void SubframeWriter::number(std::uint32_t value) noexcept {
  while (value >= 0x80) {
    byte(static_cast<std::uint8_t>(value | 0x80));
    value >>= 7;
  }
  byte(static_cast<std::uint8_t>(value));
}

void SubframeWriter::header(std::uint8_t type, std::uint32_t start, Resolution resolution,
                            std::uint32_t count) noexcept {
  const unsigned head = type | static_cast<unsigned>(resolution) << 2;
  if (count >= 1 && count <= 3) {
    byte(static_cast<std::uint8_t>(head | count));
  } else {
    byte(static_cast<std::uint8_t>(head));
    number(count);
  }
  number(start);
}

void SubframeWriter::values(SubframeKind kind, MoteusRegister start, Resolution resolution,
                            std::span<const double> values) noexcept {
  std::uint32_t register_number = static_cast<std::uint32_t>(start);
  header(kind == SubframeKind::reply ? kReplyType : kWriteType, register_number, resolution,
         static_cast<std::uint32_t>(values.size()));
  for (const double value : values) {
    std::array<std::uint8_t, 4> bytes{};
    if (resolution == Resolution::real) {
      store_float(bytes, real_of(value, saturated_));
    } else {
      store_little(bytes, static_cast<std::uint64_t>(integer_of(value, unit_of(register_number, resolution),
                                                                resolution, saturated_)));
    }
    for (std::size_t i = 0; i < bytes_of(resolution); ++i) byte(bytes[i]);
    ++register_number;
  }
}

void SubframeWriter::read(MoteusRegister start, Resolution resolution, std::uint32_t count) noexcept {
  header(kReadType, static_cast<std::uint32_t>(start), resolution, count);
}

EncodeStatus SubframeWriter::finish() noexcept {
  if (overflow_) return EncodeStatus::no_room;
  frame_.length = fd_length(size_);
  std::fill(frame_.data.begin() + static_cast<std::ptrdiff_t>(size_),
            frame_.data.begin() + static_cast<std::ptrdiff_t>(frame_.length), kPadding);
  return saturated_ ? EncodeStatus::saturated : EncodeStatus::ok;
}

}  // namespace stilt::hal::protocol
