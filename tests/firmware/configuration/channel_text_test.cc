#include "firmware/configuration/channel_text.h"

#include <gtest/gtest.h>

#include <optional>

namespace stilt::configuration {
namespace {

using hal::BaseChannel;

TEST(Channel, EveryWordSetsItsPart) {
  const auto parsed = parse_channel(
      "id 0x123456 extended byte 3 bit 2 bits 12 unsigned big scale -0.5 offset 1e2 invalid 0xfff",
      BaseChannel::pitch_rate_rad_s);
  ASSERT_TRUE(parsed && *parsed);
  const hal::ChannelRow& row = **parsed;
  EXPECT_EQ(row.id, 0x123456u);
  EXPECT_TRUE(row.extended);
  EXPECT_EQ(row.byte_offset, 3);
  EXPECT_EQ(row.bit_offset, 2);
  EXPECT_EQ(row.bits, 12);
  EXPECT_EQ(row.type, hal::RawType::unsigned_integer);
  EXPECT_EQ(row.order, hal::ByteOrder::big);
  EXPECT_EQ(row.scale, -0.5);
  EXPECT_EQ(row.offset, 100);
  EXPECT_TRUE(row.has_invalid);
  EXPECT_EQ(row.invalid_bits, 0xfffu);
  EXPECT_EQ(row.channel, BaseChannel::pitch_rate_rad_s);
}

TEST(Channel, NoneGivesNothingAndNonsenseIsNamed) {
  EXPECT_EQ(parse_channel("none", BaseChannel::pitch_rad), std::nullopt);
  for (const char* wrong : {"", "byte 0 bits 8", "id", "id x", "id 0x50 bits 40", "id 0x50 float bits 16",
                            "id 0x50 colour 3", "id 0x50 scale 0", "id 0x50 bits 300", "id 0x50 bits 264"}) {
    EXPECT_FALSE(parse_channel(wrong, BaseChannel::pitch_rad)) << wrong;
  }
  EXPECT_TRUE(parse_channel("id 0x50 colour 3", BaseChannel::pitch_rad)
                  .error()
                  .starts_with("\"colour 3\" is not understood"));
}

TEST(Channel, AWordThatIsGivenTwiceIsRefused) {
  const auto error = [](const std::string& words) {
    const auto row =
        parse_channel("id 0x150 byte 0 bits 24 signed little scale 1e-6 " + words, BaseChannel::pitch_rad);
    return row ? "" : row.error().substr(0, row.error().find(';'));
  };
  EXPECT_EQ(error(""), "");
  EXPECT_EQ(error("scale 1"), "scale is given twice");
  EXPECT_EQ(error("id 0x151"), "id is given twice");
  EXPECT_EQ(error("unsigned"), "the type is given twice");
  EXPECT_EQ(error("big"), "the byte order is given twice");
  EXPECT_EQ(error("invalid 1 invalid 1"), "invalid is given twice");
}

}  // namespace
}  // namespace stilt::configuration
