#include "hal/moteus/moteus_subframes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/can/bytes.h"

namespace stilt::hal::moteus {
namespace {

constexpr std::uint8_t kTypeMask = 0xf0;
constexpr std::uint8_t kWriteType = 0x00;
constexpr std::uint8_t kReadType = 0x10;
constexpr std::uint8_t kReplyType = 0x20;
constexpr std::uint8_t kWriteError = 0x30;
constexpr std::uint8_t kReadError = 0x31;
constexpr std::uint8_t kStreamIn = 0x40;
constexpr std::uint8_t kStreamOut = 0x41;
constexpr std::uint8_t kStreamPoll = 0x42;
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

struct RegisterRange {
  std::uint32_t first;
  std::uint32_t last;
  Quantity quantity;
};

/// What the registers measure; all others are plain numbers: docs/protocol/registers.md.
constexpr RegisterRange kRanges[] = {
    {0x001, 0x001, Quantity::position},    {0x002, 0x002, Quantity::velocity},
    {0x003, 0x003, Quantity::torque},      {0x004, 0x005, Quantity::current},
    {0x006, 0x006, Quantity::position},    {0x007, 0x007, Quantity::power},
    {0x00a, 0x00a, Quantity::temperature}, {0x00d, 0x00d, Quantity::voltage},
    {0x00e, 0x00e, Quantity::temperature}, {0x010, 0x012, Quantity::fraction},
    {0x014, 0x016, Quantity::voltage},     {0x018, 0x018, Quantity::fraction},
    {0x019, 0x01b, Quantity::voltage},     {0x01c, 0x01d, Quantity::current},
    {0x01e, 0x01e, Quantity::velocity},    {0x020, 0x020, Quantity::position},
    {0x021, 0x021, Quantity::velocity},    {0x022, 0x022, Quantity::torque},
    {0x023, 0x024, Quantity::fraction},    {0x025, 0x025, Quantity::torque},
    {0x026, 0x026, Quantity::position},    {0x027, 0x027, Quantity::time},
    {0x028, 0x028, Quantity::velocity},    {0x029, 0x029, Quantity::acceleration},
    {0x02a, 0x02a, Quantity::voltage},     {0x02b, 0x02b, Quantity::fraction},
    {0x02c, 0x02c, Quantity::current},     {0x030, 0x034, Quantity::torque},
    {0x038, 0x038, Quantity::position},    {0x039, 0x039, Quantity::velocity},
    {0x03a, 0x03a, Quantity::torque},      {0x03b, 0x03b, Quantity::position},
    {0x03c, 0x03c, Quantity::velocity},    {0x03d, 0x03d, Quantity::torque},
    {0x040, 0x041, Quantity::position},    {0x042, 0x042, Quantity::torque},
    {0x043, 0x044, Quantity::fraction},    {0x045, 0x045, Quantity::torque},
    {0x046, 0x046, Quantity::time},        {0x047, 0x047, Quantity::fraction},
    {0x050, 0x050, Quantity::position},    {0x051, 0x051, Quantity::velocity},
    {0x052, 0x052, Quantity::position},    {0x053, 0x053, Quantity::velocity},
    {0x054, 0x054, Quantity::position},    {0x055, 0x055, Quantity::velocity},
    {0x130, 0x131, Quantity::position},
};

constexpr std::size_t kRegisters = 0x132;

constexpr std::array<Quantity, kRegisters> kQuantities = [] {
  std::array<Quantity, kRegisters> quantities{};
  for (const RegisterRange& range : kRanges) {
    for (std::uint32_t number = range.first; number <= range.last; ++number) {
      quantities[number] = range.quantity;
    }
  }
  return quantities;
}();

Quantity quantity_of(std::uint32_t register_number) noexcept {
  return register_number < kRegisters ? kQuantities[register_number] : Quantity::plain;
}

/// Value of the least significant bit in int8, int16 and int32: docs/protocol/registers.md, "Mappings".
struct Units {
  double int8;
  double int16;
  double int32;
};

/// By Quantity.
constexpr Units kUnits[] = {
    {1, 1, 1},                                   // plain
    {0.01, 0.0001, 0.00001},                     // position
    {0.1, 0.00025, 0.00001},                     // velocity
    {0.5, 0.01, 0.001},                          // torque
    {1, 0.1, 0.001},                             // current
    {0.5, 0.1, 0.001},                           // voltage
    {1, 0.1, 0.001},                             // temperature
    {0.01, 0.001, 0.000001},                     // time
    {1.0 / 127, 1.0 / 32767, 1.0 / 2147483647},  // fraction
    {10, 0.05, 0.0001},                          // power
    {0.05, 0.001, 0.00001},                      // acceleration
};

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
  const Units& units = kUnits[static_cast<std::size_t>(quantity_of(register_number))];
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

bool SubframeReader::take_values(std::size_t size, Subframe& subframe) noexcept {
  if (size > rest_.size()) return false;
  subframe.values = rest_.first(size);
  rest_ = rest_.subspan(size);
  return true;
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
  } else if (head >= kStreamIn && head <= kStreamPoll) {
    if (!next_stream(head, found)) return fail();
  } else if (!next_registers(head, found)) {
    return fail();
  }
  subframe = found;
  return true;
}

bool SubframeReader::next_stream(std::uint8_t head, Subframe& subframe) noexcept {
  subframe.kind = head == kStreamIn    ? SubframeKind::stream_in
                  : head == kStreamOut ? SubframeKind::stream_out
                                       : SubframeKind::stream_poll;
  if (!take_number(subframe.start) || !take_number(subframe.count)) return false;
  return head == kStreamPoll || take_values(subframe.count, subframe);
}

bool SubframeReader::next_registers(std::uint8_t head, Subframe& subframe) noexcept {
  switch (head & kTypeMask) {
    case kWriteType:
      subframe.kind = SubframeKind::write;
      break;
    case kReadType:
      subframe.kind = SubframeKind::read;
      break;
    case kReplyType:
      subframe.kind = SubframeKind::reply;
      break;
    default:
      return false;
  }
  subframe.resolution = static_cast<Resolution>(head >> 2 & 0x3);
  subframe.count = head & 0x3;
  if (subframe.count == 0 && !take_number(subframe.count)) return false;
  if (!take_number(subframe.start)) return false;
  if (subframe.count == 0 || subframe.count > kMaximumFrameBytes || subframe.start > kMaximumRegister) {
    return false;
  }
  return subframe.kind == SubframeKind::read ||
         take_values(subframe.count * bytes_of(subframe.resolution), subframe);
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

void SubframeWriter::stream(SubframeKind kind, std::uint32_t channel,
                            std::span<const std::uint8_t> bytes) noexcept {
  byte(kind == SubframeKind::stream_in ? kStreamIn : kStreamOut);
  number(channel);
  number(static_cast<std::uint32_t>(bytes.size()));
  for (const std::uint8_t each : bytes) byte(each);
}

void SubframeWriter::poll_stream(std::uint32_t channel, std::uint32_t count) noexcept {
  byte(kStreamPoll);
  number(channel);
  number(count);
}

EncodeStatus SubframeWriter::finish() noexcept {
  if (overflow_) return EncodeStatus::no_room;
  frame_.length = fd_length(size_);
  std::fill(frame_.data.begin() + static_cast<std::ptrdiff_t>(size_),
            frame_.data.begin() + static_cast<std::ptrdiff_t>(frame_.length), kPadding);
  return saturated_ ? EncodeStatus::saturated : EncodeStatus::ok;
}

}  // namespace stilt::hal::moteus
