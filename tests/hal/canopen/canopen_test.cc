#include "hal/canopen/canopen.h"

#include <gtest/gtest.h>

#include "tests/hal/hex.h"
#include "tests/hal/random_values.h"

// Byte vectors of the vendors' manuals:
//   Festo, "CiA 402 for motor controller CMMS", GDCP-CMMS/D-C-CO-EN, 1404NH, page 20
//   Pepperl+Fuchs, "Absolute Rotary Encoder, CANopen", 2017-04, tables 7.1 to 7.15, 8.4
//   EAO, "Series 09 CANopen", page 51: boot-up and start of node 0x0b
namespace stilt::hal::canopen {
namespace {

using stilt::hal::testing::hex;
using stilt::hal::testing::RandomValues;
using stilt::hal::testing::with_payload;

SdoAnswer answer_of(std::uint8_t node, const char* bytes) {
  SdoAnswer answer;
  EXPECT_EQ(decode_answer(node, with_payload(classic_frame(0x580u + node, 8), bytes), answer),
            DecodeStatus::ok);
  return answer;
}

TEST(Canopen, ReadsAreThoseOfTheManuals) {
  const CanFrame frame = sdo_read_frame(0x0b, {0x6041, 0});
  EXPECT_EQ(frame.id, 0x60bu);
  EXPECT_EQ(hex(frame), "4041600000000000");
  EXPECT_EQ(hex(sdo_read_frame(1, {0x6093, 1})), "4093600100000000");
}

TEST(Canopen, WritesAreThoseOfTheManuals) {
  EXPECT_EQ(hex(sdo_write_frame(1, {0x1401, 2}, 0xef, 1)), "2f011402ef000000");
  EXPECT_EQ(hex(sdo_write_frame(1, {0x6040, 0}, 0x03e8, 2)), "2b406000e8030000");
  EXPECT_EQ(hex(sdo_write_frame(1, {0x6093, 1}, 0x12345678, 4)), "2393600178563412");
}

TEST(Canopen, AnswersAreReadAsTheManualsMeanThem) {
  SdoAnswer answer = answer_of(1, "4f61600001000000");
  EXPECT_EQ(answer.kind, SdoAnswer::Kind::value);
  EXPECT_EQ(answer.object, (Object{0x6061, 0}));
  EXPECT_EQ(answer.value, 1u);
  EXPECT_EQ(answer_of(1, "4b41600034120000").value, 0x1234u);
  EXPECT_EQ(answer_of(1, "4393600178563412").value, 0x12345678u);
  answer = answer_of(0x0b, "6000180500000000");  // table 7.15
  EXPECT_EQ(answer.kind, SdoAnswer::Kind::written);
  EXPECT_EQ(answer.object, (Object{0x1800, 5}));
}

TEST(Canopen, WhatLiesBeyondAShortObjectIsNotItsValue) {
  EXPECT_EQ(answer_of(1, "4f616000017f7f7f").value, 1u);
  EXPECT_EQ(answer_of(1, "4b41600034127f7f").value, 0x1234u);
}

/// The manual's writes leave the size open: 22h.
TEST(Canopen, AWriteWithoutASizeIsReadByTheEmulatedNode) {
  SdoRequest request;
  const CanFrame frame = with_payload(classic_frame(0x60b, 8), "2200180564000000");  // table 7.14
  ASSERT_EQ(decode_request(0x0b, frame, request), DecodeStatus::ok);
  EXPECT_TRUE(request.write);
  EXPECT_EQ(request.object, (Object{0x1800, 5}));
  EXPECT_EQ(request.value, 100u);
  EXPECT_EQ(request.bytes, 0);
}

TEST(Canopen, NetworkManagementIsThatOfTheManuals) {
  EXPECT_EQ(nmt_frame(NmtCommand::start, 0x0b).id, 0u);
  EXPECT_EQ(hex(nmt_frame(NmtCommand::start, 0x0b)), "010b");
  EXPECT_EQ(hex(nmt_frame(NmtCommand::reset_communication, 0)), "8200");
  EXPECT_EQ(hex(nmt_frame(NmtCommand::reset_node, 0x20)), "8120");
  const auto state = [](std::uint32_t id, const char* bytes) {
    return decode_heartbeat(0x0b, with_payload(classic_frame(id, 1), bytes));
  };
  EXPECT_EQ(state(0x70b, "00"), NmtState::boot_up);
  EXPECT_EQ(state(0x70b, "7f"), NmtState::pre_operational);
  EXPECT_EQ(state(0x70b, "05"), NmtState::operational);
  EXPECT_EQ(state(0x70b, "85"), NmtState::operational) << "the toggle bit of node guarding";
  EXPECT_EQ(state(0x70c, "05"), std::nullopt);
  EXPECT_EQ(state(0x70b, "0505"), std::nullopt);
}

TEST(Canopen, FramesThatAreNoAnswerAreRefused) {
  SdoAnswer answer;
  const auto status = [&answer](CanFrame frame, const char* bytes) {
    return decode_answer(1, with_payload(frame, bytes), answer);
  };
  const CanFrame right = classic_frame(0x581, 8);
  EXPECT_EQ(status(classic_frame(0x582, 8), "4f61600001000000"), DecodeStatus::not_addressed);
  EXPECT_EQ(status(right, "4f616000010000"), DecodeStatus::wrong_length);
  EXPECT_EQ(status(right, "4161600010000000"), DecodeStatus::malformed)
      << "an object of 16 bytes, in segments";
  EXPECT_EQ(status(right, "0061600001000000"), DecodeStatus::malformed);
  CanFrame extended = right;
  extended.extended = true;
  EXPECT_EQ(status(extended, "4f61600001000000"), DecodeStatus::not_addressed);
}

TEST(Canopen, EveryAnswerSurvivesTheWay) {
  constexpr std::uint64_t kSeed = 406;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  for (int i = 0; i < 20000; ++i) {
    const auto node = static_cast<std::uint8_t>(1 + random.below(127));
    const std::uint8_t bytes = random.chance(0.3) ? 1 : random.chance(0.5) ? 2 : 4;
    const std::uint32_t mask = bytes == 4 ? 0xffffffffu : (1u << 8 * bytes) - 1;
    SdoAnswer sent{
        static_cast<SdoAnswer::Kind>(random.below(3)),
        {static_cast<std::uint16_t>(random.below(65536)), static_cast<std::uint8_t>(random.below(256))},
        random.below(0xffffffff) & mask};
    if (sent.kind == SdoAnswer::Kind::written) sent.value = 0;
    SdoAnswer received;
    ASSERT_EQ(decode_answer(node, answer_frame(node, sent, bytes), received), DecodeStatus::ok);
    ASSERT_EQ(received.kind, sent.kind);
    ASSERT_EQ(received.object, sent.object);
    ASSERT_EQ(received.value, sent.value);
  }
}

}  // namespace
}  // namespace stilt::hal::canopen
