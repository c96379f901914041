#include "hal/mit/damiao_registers.h"

#include <gtest/gtest.h>

#include <bit>

#include "tests/hal/hex.h"
#include "tests/hal/random_values.h"

namespace stilt::hal::mit {
namespace {

using stilt::hal::testing::hex;
using stilt::hal::testing::RandomValues;

MitDriver driver() {
  MitDriver driver;
  driver.command_id = 0x01;
  driver.reply_id = 0x11;
  driver.layout = ReplyLayout::damiao;
  return driver;
}

TEST(DamiaoRegisters, RequestsHaveTheDocumentedBytes) {
  CanFrame frame;
  ASSERT_EQ(encode_register_request(driver(), {.number = 9}, frame), EncodeStatus::ok);
  EXPECT_EQ(frame.id, 0x7ffu);
  EXPECT_EQ(hex(frame), "0100330900000000");
  ASSERT_EQ(encode_register_request(driver(), {true, 9, 400}, frame), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "0100550990010000") << "20 ms in units of 50 us";
  ASSERT_EQ(encode_register_request(driver(), {true, 21, std::bit_cast<std::uint32_t>(12.5f)}, frame),
            EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "0100551500004841");
}

TEST(DamiaoRegisters, MessagesComeBackBothWays) {
  constexpr std::uint64_t kSeed = 4151;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  for (int i = 0; i < 10'000; ++i) {
    const DamiaoRegisterMessage message{random.chance(0.5), static_cast<std::uint8_t>(random.below(256)),
                                        random.below(0xffffffff)};
    CanFrame frame;
    DamiaoRegisterMessage back;
    ASSERT_EQ(encode_register_request(driver(), message, frame), EncodeStatus::ok);
    ASSERT_EQ(decode_register_request(driver(), frame, back), DecodeStatus::ok);
    ASSERT_EQ(back.write, message.write);
    ASSERT_EQ(back.number, message.number);
    ASSERT_EQ(back.bits, message.bits);
    ASSERT_EQ(encode_register_answer(driver(), message, frame), EncodeStatus::ok);
    ASSERT_EQ(decode_register_answer(driver(), frame, back), DecodeStatus::ok);
    ASSERT_EQ(back.bits, message.bits);
  }
}

TEST(DamiaoRegisters, OtherFramesOfTheReplyIdentifierAreNotReplies) {
  CanFrame frame;
  ASSERT_EQ(encode_register_answer(driver(), {.number = 9, .bits = 400}, frame), EncodeStatus::ok);
  DamiaoRegisterMessage message;
  CanFrame other = frame;
  other.data[2] = 0x80;
  EXPECT_EQ(decode_register_answer(driver(), other, message), DecodeStatus::not_addressed) << "a state reply";
  other = frame;
  other.data[0] = 2;
  EXPECT_EQ(decode_register_answer(driver(), other, message), DecodeStatus::not_addressed)
      << "another driver";
  other = frame;
  other.length = 7;
  EXPECT_EQ(decode_register_answer(driver(), other, message), DecodeStatus::wrong_length);
}

}  // namespace
}  // namespace stilt::hal::mit
