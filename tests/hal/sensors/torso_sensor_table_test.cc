#include "hal/sensors/torso_sensor_table.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>

#include "tests/hal/hex.h"
#include "tests/hal/random_values.h"

namespace stilt::hal {
namespace {

using stilt::hal::testing::hex;
using stilt::hal::testing::RandomValues;
using stilt::hal::testing::with_payload;

ChannelRow row(ByteOrder order, RawType type, std::uint8_t byte_offset, std::uint8_t bits) {
  ChannelRow row;
  row.id = 0x50;
  row.order = order;
  row.type = type;
  row.byte_offset = byte_offset;
  row.bits = bits;
  return row;
}

double decoded(const ChannelRow& row, std::string_view digits) {
  ChannelValues values;
  EXPECT_EQ(decode(std::span(&row, 1), with_payload(classic_frame(row.id, 8), digits), values),
            DecodeStatus::ok);
  EXPECT_TRUE(values.has(row.channel));
  return values[row.channel];
}

TEST(TorsoSensorTable, BothByteOrdersSignedAndUnsigned) {
  EXPECT_EQ(decoded(row(ByteOrder::little, RawType::unsigned_integer, 1, 16), "00 34 12 00"), 0x1234);
  EXPECT_EQ(decoded(row(ByteOrder::big, RawType::unsigned_integer, 1, 16), "00 12 34 00"), 0x1234);
  EXPECT_EQ(decoded(row(ByteOrder::little, RawType::signed_integer, 0, 16), "fe ff"), -2);
  EXPECT_EQ(decoded(row(ByteOrder::big, RawType::signed_integer, 0, 24), "ff ff fe"), -2);
  EXPECT_EQ(decoded(row(ByteOrder::little, RawType::signed_integer, 0, 32), "00 00 00 80"), -2147483648.0);
  EXPECT_EQ(decoded(row(ByteOrder::little, RawType::float32, 4, 32), "00000000 0000c03f"), 1.5);
  EXPECT_EQ(decoded(row(ByteOrder::big, RawType::float32, 0, 32), "3fc00000"), 1.5);
}

TEST(TorsoSensorTable, FieldsMayStartInsideAByte) {
  ChannelRow little = row(ByteOrder::little, RawType::unsigned_integer, 0, 12);
  little.bit_offset = 4;
  EXPECT_EQ(decoded(little, "5f a3"), 0xa35);
  ChannelRow big = row(ByteOrder::big, RawType::unsigned_integer, 0, 12);
  big.bit_offset = 4;
  EXPECT_EQ(decoded(big, "a3 5f"), 0xa35);
}

TEST(TorsoSensorTable, ScaleAndOffsetApplyInThatOrder) {
  ChannelRow centi = row(ByteOrder::little, RawType::signed_integer, 0, 16);
  centi.scale = -0.01;
  centi.offset = 3;
  EXPECT_DOUBLE_EQ(decoded(centi, "c8 00"), 1);
}

TEST(TorsoSensorTable, OneFrameMayCarrySeveralChannels) {
  std::array<ChannelRow, 3> table{row(ByteOrder::little, RawType::signed_integer, 0, 16),
                                  row(ByteOrder::little, RawType::signed_integer, 2, 16),
                                  row(ByteOrder::little, RawType::signed_integer, 0, 16)};
  table[1].channel = BaseChannel::pitch_rate_rad_s;
  table[2].id = 0x51;
  table[2].channel = BaseChannel::acceleration_x_m_s2;
  ChannelValues values;
  ASSERT_EQ(decode(table, with_payload(classic_frame(0x50, 4), "0100feff"), values), DecodeStatus::ok);
  EXPECT_EQ(values[BaseChannel::pitch_rad], 1);
  EXPECT_EQ(values[BaseChannel::pitch_rate_rad_s], -2);
  EXPECT_FALSE(values.has(BaseChannel::acceleration_x_m_s2));
}

TEST(TorsoSensorTable, AValueTheSensorMarksMissingIsNotPresent) {
  ChannelRow marked = row(ByteOrder::little, RawType::signed_integer, 0, 16);
  marked.has_invalid = true;
  marked.invalid_bits = 0x8000;
  ChannelValues values;
  ASSERT_EQ(decode(std::span(&marked, 1), with_payload(classic_frame(0x50, 2), "0080"), values),
            DecodeStatus::ok);
  EXPECT_FALSE(values.has(BaseChannel::pitch_rad));
}

TEST(TorsoSensorTable, RandomFieldsComeBackAndLeaveTheirNeighboursAlone) {
  constexpr std::uint64_t kSeed = 4401;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  int tried = 0;
  while (tried < 100'000) {
    ChannelRow field =
        row(random.chance(0.5) ? ByteOrder::little : ByteOrder::big, static_cast<RawType>(random.below(3)),
            static_cast<std::uint8_t>(random.below(64)), static_cast<std::uint8_t>(1 + random.below(32)));
    if (field.type == RawType::float32) field.bits = 32;
    field.bit_offset = static_cast<std::uint8_t>(random.below(8));
    field.scale = random.between(0.001, 2) * (random.chance(0.5) ? 1 : -1);
    field.offset = random.between(-10, 10);
    if (!valid(field)) continue;
    ++tried;
    CanFrame frame = random.frame();
    frame.id = field.id;
    frame.extended = frame.remote = frame.error = false;
    frame.fd = true;
    frame.length = 64;
    const CanFrame before = frame;
    const double top =
        std::ldexp(1.0, field.type == RawType::unsigned_integer ? field.bits : field.bits - 1) - 1;
    const double raw = std::round(random.between(field.type == RawType::unsigned_integer ? 0 : -top, top));
    const double value =
        field.type == RawType::float32 ? random.between(-100, 100) : field.scale * raw + field.offset;
    ASSERT_EQ(encode(field, value, frame), EncodeStatus::ok);
    ChannelValues values;
    ASSERT_EQ(decode(std::span(&field, 1), frame, values), DecodeStatus::ok);
    ASSERT_NEAR(values[field.channel], value, 1e-5 * (1 + std::abs(value)));
    CanFrame again = before;
    ASSERT_EQ(encode(field, values[field.channel], again), EncodeStatus::ok);
    ASSERT_EQ(again, frame);
    int changed_bits = 0;
    for (std::size_t i = 0; i < frame.data.size(); ++i) {
      changed_bits += std::popcount(static_cast<unsigned>(frame.data[i] ^ before.data[i]));
    }
    ASSERT_LE(changed_bits, field.bits);
  }
}

TEST(TorsoSensorTable, FramesThatDoNotFitAreNamed) {
  const ChannelRow field = row(ByteOrder::little, RawType::float32, 0, 32);
  ChannelValues values;
  values.present = 1;
  EXPECT_EQ(decode(std::span(&field, 1), classic_frame(0x51, 8), values), DecodeStatus::not_addressed);
  EXPECT_EQ(decode(std::span(&field, 1), classic_frame(0x50, 3), values), DecodeStatus::wrong_length);
  EXPECT_EQ(decode(std::span(&field, 1), with_payload(classic_frame(0x50, 4), "0000c07f"), values),
            DecodeStatus::not_finite);
  EXPECT_EQ(values.present, 1u) << "the output stays as it was";
  CanFrame frame = classic_frame(0x50, 4);
  frame.extended = true;
  EXPECT_EQ(decode(std::span(&field, 1), frame, values), DecodeStatus::not_addressed);
}

TEST(TorsoSensorTable, FieldsOverlapByTheirBitsInAFrame) {
  const ChannelRow low = row(ByteOrder::little, RawType::unsigned_integer, 0, 12);
  ChannelRow high = row(ByteOrder::little, RawType::unsigned_integer, 1, 12);
  high.bit_offset = 4;
  ChannelRow between = row(ByteOrder::little, RawType::unsigned_integer, 1, 4);
  between.bit_offset = 3;
  EXPECT_FALSE(overlap(low, high)) << "they share a byte";
  EXPECT_TRUE(overlap(low, between));
  EXPECT_TRUE(overlap(between, high));
  ChannelRow other = low;
  other.id = low.id + 1;
  EXPECT_FALSE(overlap(low, other));
  other = low;
  other.extended = !low.extended;
  EXPECT_FALSE(overlap(low, other));
}

TEST(TorsoSensorTable, RowsWithoutSenseAreRefused) {
  EXPECT_FALSE(valid(row(ByteOrder::little, RawType::float32, 0, 31)));
  EXPECT_FALSE(valid(row(ByteOrder::little, RawType::signed_integer, 0, 0)));
  EXPECT_FALSE(valid(row(ByteOrder::little, RawType::signed_integer, 0, 33)));
  EXPECT_FALSE(valid(row(ByteOrder::little, RawType::signed_integer, 63, 16)));
  ChannelRow flat = row(ByteOrder::little, RawType::signed_integer, 0, 16);
  flat.scale = 0;
  EXPECT_FALSE(valid(flat));
}

}  // namespace
}  // namespace stilt::hal
