#include "hal/vectornav/vectornav.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

namespace stilt::hal::vectornav {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// All messages of a stream that comes in parts of this many bytes.
std::vector<Packet> packets_of(Stream& stream, const Bytes& bytes, std::size_t part) {
  std::vector<Packet> found;
  for (std::size_t begin = 0; begin < bytes.size(); begin += part) {
    const auto rest = std::span(bytes).subspan(begin);
    const auto now = rest.first(std::min(part, rest.size()));
    EXPECT_EQ(stream.push(now), now.size());
    Packet packet;
    while (stream.next(packet)) found.push_back(packet);
  }
  return found;
}

/// UM001, document revision 2.22, chapter 4.3.7, example case 1: group 1 with yaw, pitch and roll alone.
const Bytes kExample{0xfa, 0x01, 0x08, 0x00, 0x93, 0x50, 0x2e, 0x42, 0x83,
                     0x3e, 0xf1, 0x3f, 0x48, 0xb5, 0x04, 0xbb, 0x92, 0x88};

TEST(Vectornav, TheExampleOfTheManualIsReadAsItSays) {
  for (const std::size_t part : {1u, 3u, 18u}) {
    Stream stream;
    const auto found = packets_of(stream, kExample, part);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_FLOAT_EQ(static_cast<float>(found[0].yaw_deg), 43.578686f);
    EXPECT_FLOAT_EQ(static_cast<float>(found[0].pitch_deg), 1.8847202f);
    EXPECT_FLOAT_EQ(static_cast<float>(found[0].roll_deg), -2.0249654e-3f);
    EXPECT_TRUE(std::isnan(found[0].rate_rad_s[1])) << "has no rates";
    EXPECT_EQ(stream.malformed(), 0u);
  }
}

TEST(Vectornav, AByteOfTheExampleThatIsWrongIsAWrongChecksum) {
  for (std::size_t at = 4; at < kExample.size(); ++at) {
    Bytes wrong = kExample;
    wrong[at] ^= 0x10;
    Stream stream;
    EXPECT_TRUE(packets_of(stream, wrong, 5).empty()) << at;
    EXPECT_EQ(stream.malformed(), 1u) << at;
  }
}

Bytes message(double pitch_deg, double rate_rad_s) {
  const auto bytes = encode({10, pitch_deg, -3, {0.1, rate_rad_s, 0.3}});
  return {bytes.begin(), bytes.end()};
}

TEST(Vectornav, WhatIsEncodedIsReadBack) {
  Stream stream;
  const auto found = packets_of(stream, message(12.5, -2.25), 7);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].yaw_deg, 10);
  EXPECT_EQ(found[0].pitch_deg, 12.5);
  EXPECT_EQ(found[0].roll_deg, -3);
  EXPECT_EQ(found[0].rate_rad_s[1], -2.25);
}

/// Register 75 may ask for more than is needed: here also the time since start-up (8 bytes, before the
/// angles), as table 4.3.6 orders the fields.
TEST(Vectornav, OtherFieldsOfTheMessageAreSteppedOver) {
  Bytes bytes = message(5, 6);
  bytes[2] |= 0x01;
  bytes.insert(bytes.begin() + 4, 8, std::uint8_t{0});
  bytes.erase(bytes.end() - 2, bytes.end());
  std::uint16_t check = 0;  // bit by bit, x^16 + x^12 + x^5 + 1
  for (std::size_t i = 1; i < bytes.size(); ++i) {
    for (int bit = 7; bit >= 0; --bit) {
      const bool feedback = ((check >> 15) ^ (bytes[i] >> bit & 1)) != 0;
      check = static_cast<std::uint16_t>(check << 1);
      if (feedback) check ^= 0x1021;
    }
  }
  bytes.push_back(static_cast<std::uint8_t>(check >> 8));
  bytes.push_back(static_cast<std::uint8_t>(check & 0xff));
  Stream stream;
  const auto found = packets_of(stream, bytes, 11);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].pitch_deg, 5);
  EXPECT_EQ(found[0].rate_rad_s[1], 6);
}

TEST(Vectornav, AWrongByteLosesOneMessageOnly) {
  constexpr int kMessages = 20;
  for (std::size_t at = 0; at < kPacketBytes; ++at) {
    for (const int flip : {0x01, 0x80, 0xff}) {
      Bytes bytes;
      for (int i = 0; i < kMessages; ++i) {
        const Bytes one = message(i, 0);
        bytes.insert(bytes.end(), one.begin(), one.end());
      }
      bytes[7 * kPacketBytes + at] = static_cast<std::uint8_t>(bytes[7 * kPacketBytes + at] ^ flip);
      Stream stream;
      const auto found = packets_of(stream, bytes, 13);
      ASSERT_EQ(found.size(), kMessages - 1u) << "byte " << at << " of message 7";
      EXPECT_EQ(found[6].pitch_deg, 6);
      EXPECT_EQ(found[7].pitch_deg, 8);
    }
  }
}

TEST(Vectornav, ALostByteLosesOneMessageOnly) {
  for (std::size_t at = 0; at < kPacketBytes; ++at) {
    Bytes bytes;
    for (int i = 0; i < 20; ++i) {
      const Bytes one = message(i, 0);
      bytes.insert(bytes.end(), one.begin(), one.end());
    }
    bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(7 * kPacketBytes + at));
    Stream stream;
    EXPECT_EQ(packets_of(stream, bytes, 13).size(), 19u) << at;
    EXPECT_GT(stream.skipped_bytes(), 0u);
  }
}

/// Also garbage that is full of sync bytes and headers.
TEST(Vectornav, EveryMessageBetweenGarbageIsFoundAndNoOther) {
  constexpr std::uint64_t kSeed = 100;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 random(kSeed);
  for (int round = 0; round < 300; ++round) {
    Bytes bytes;
    std::vector<double> sent;
    for (int i = 0; i < 30; ++i) {
      for (std::uint64_t n = random() % 60; n > 0; --n) {
        const auto any = static_cast<std::uint8_t>(random());
        const std::uint8_t likely[] = {0xfa, 0x01, 0x28, 0x00};
        bytes.push_back(random() % 2 == 0 ? any : likely[random() % 4]);
      }
      const double pitch_deg = static_cast<double>(random() % 1000) / 8;
      const Bytes one = message(pitch_deg, 0.5);
      bytes.insert(bytes.end(), one.begin(), one.end());
      sent.push_back(pitch_deg);
    }
    bytes.insert(bytes.end(), Stream::kLongestPacket, std::uint8_t{0});  // flushes what is under suspicion
    Stream stream;
    const auto found = packets_of(stream, bytes, 1 + random() % 64);
    ASSERT_EQ(found.size(), sent.size()) << round;
    for (std::size_t i = 0; i < sent.size(); ++i) ASSERT_EQ(found[i].pitch_deg, sent[i]) << round;
  }
}

TEST(Vectornav, AnglesThatAreNoNumbersAreNoPacket) {
  const auto bytes = encode({0, std::nan(""), 0, {0, 0, 0}});
  Stream stream;
  EXPECT_TRUE(packets_of(stream, {bytes.begin(), bytes.end()}, 30).empty());
  EXPECT_EQ(stream.malformed(), 1u);
}

TEST(Vectornav, AStreamWithoutAReaderKeepsItsFirstBytes) {
  Stream stream;
  const Bytes much(1000, 0xfa);
  EXPECT_EQ(stream.push(much), Stream::kCapacity);
  EXPECT_EQ(stream.push(much), 0u);
}

/// Nose up (positive) leans the torso backward (negative); the unit's y points to the right, the torso's to
/// the left. Mounted with x to the left, its right side goes down as the torso leans forward.
TEST(Vectornav, ThePitchOfTheTorsoIsPositiveForward) {
  constexpr double kDegree_rad = std::numbers::pi / 180;
  const Packet packet{0, 10, 20, {0.1, 0.2, 0.3}};
  Pitch pitch = pitch_of(packet, {});
  EXPECT_DOUBLE_EQ(pitch.angle_rad, -10 * kDegree_rad);
  EXPECT_DOUBLE_EQ(pitch.rate_rad_s, -0.2);
  pitch = pitch_of(packet, {.direction = -1, .offset_rad = 0.05});
  EXPECT_DOUBLE_EQ(pitch.angle_rad, 10 * kDegree_rad + 0.05);
  EXPECT_DOUBLE_EQ(pitch.rate_rad_s, 0.2);
  pitch = pitch_of(packet, {.by_roll = true});
  EXPECT_DOUBLE_EQ(pitch.angle_rad, 20 * kDegree_rad);
  EXPECT_DOUBLE_EQ(pitch.rate_rad_s, 0.1);
}

TEST(Vectornav, ThePacketOfAPitchHasThatPitch) {
  for (const bool by_roll : {false, true}) {
    for (const double direction : {-1.0, 1.0}) {
      const Mounting mounting{by_roll, direction, 0.03};
      const Pitch pitch = pitch_of(packet_of({0.4, -1.5}, mounting), mounting);
      EXPECT_NEAR(pitch.angle_rad, 0.4, 1e-12);
      EXPECT_NEAR(pitch.rate_rad_s, -1.5, 1e-12);
    }
  }
}

}  // namespace
}  // namespace stilt::hal::vectornav
