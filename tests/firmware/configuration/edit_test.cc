#include "firmware/configuration/edit.h"

#include <gtest/gtest.h>

#include <array>

#include "firmware/configuration/channel_text.h"
#include "firmware/configuration/configuration.h"

namespace stilt::configuration {
namespace {

std::string edited(std::string_view toml, std::vector<NewValue> values) {
  const auto text = with_values(toml, "robot.toml", values);
  EXPECT_TRUE(text) << to_string(text.error());
  return text.value_or("");
}

TEST(Edit, ChangesValuesInPlaceAndKeepsComments) {
  constexpr const char* kFile =
      "# Grüße, my robot\n"
      "[hip_L]  # left\n"
      "offset_rad = 0.5 # Maß of May\n"
      "id = 7\n"
      "\n"
      "[knee_L]\n"
      "reversed=false\n";
  EXPECT_EQ(edited(kFile, {{"hip_L", "offset_rad", "-0.25"}, {"knee_L", "reversed", "true"}}),
            "# Grüße, my robot\n"
            "[hip_L]  # left\n"
            "offset_rad = -0.25 # Maß of May\n"
            "id = 7\n"
            "\n"
            "[knee_L]\n"
            "reversed=true\n");
}

TEST(Edit, AddsKeysToTheirSectionAndSectionsToTheEnd) {
  EXPECT_EQ(edited("[hip_L]\nid = 7 # seven\n\n[knee_L]\n", {{"hip_L", "offset_rad", "0.1"},
                                                             {"knee_L", "reversed", "true"},
                                                             {"hip_R", "offset_rad", "0.2"}}),
            "[hip_L]\nid = 7 # seven\noffset_rad = 0.1\n\n[knee_L]\nreversed = true\n\n[hip_R]\noffset_rad = "
            "0.2\n");
  EXPECT_EQ(edited("", {{"hip_L", "id", "7"}}), "[hip_L]\nid = 7\n");
  EXPECT_EQ(edited("[hip_L]", {{"hip_L", "id", "7"}}), "[hip_L]\nid = 7");
}

TEST(Edit, AddsKeysAsTheirSectionIsWritten) {
  EXPECT_EQ(
      edited("hip_L.id = 7\nhip_L.bus = 0 # ä\nknee_L.id = 8\n\n[gait]\n",
             {{"hip_L", "offset_rad", "0.1"}, {"hip_L", "id", "9"}, {"knee_L", "reversed", "true"}}),
      "hip_L.id = 9\nhip_L.bus = 0 # ä\nhip_L.offset_rad = 0.1\nknee_L.id = 8\nknee_L.reversed = true\n\n"
      "[gait]\n");
  EXPECT_EQ(edited("hip_L = { id = 7, s = \"ä}\" } # {}\n[gait]\n",
                   {{"hip_L", "offset_rad", "0.1"}, {"hip_L", "reversed", "true"}, {"hip_L", "id", "9"}}),
            "hip_L = { id = 9, s = \"ä}\", offset_rad = 0.1, reversed = true } # {}\n[gait]\n");
  EXPECT_EQ(edited("hip_L = {}", {{"hip_L", "id", "7"}}), "hip_L = { id = 7 }");
  EXPECT_EQ(edited("  [ hip_L ] # head\n[gait]\n", {{"hip_L", "id", "7"}}),
            "  [ hip_L ] # head\nid = 7\n[gait]\n");
}

TEST(Edit, ReplacesWords) {
  EXPECT_EQ(edited("[hardware]\nrobot = \"amber3m\" # ours\n", {{"hardware", "robot", "\"rabbit\""}}),
            "[hardware]\nrobot = \"rabbit\" # ours\n");
}

TEST(Edit, TheShippedFileStaysAConfiguration) {
  const ShippedConfiguration& shipped = shipped_configurations().front();
  const std::string text =
      edited(shipped.text, {{"hip_R", "offset_rad", "1"}, {"knee_L", "reversed", "true"}});
  const auto read = parse(text, "robot.toml");
  ASSERT_TRUE(read) << to_string(read.error());
  EXPECT_EQ(read->hardware.joint[2].offset_rad, 1.0);
  EXPECT_TRUE(read->hardware.joint[1].reversed);
}

TEST(Edit, RefusesWhatIsNotToml) {
  const std::array values = {NewValue{"hip_L", "id", "7"}};
  const auto text = with_values("[hip_L\n", "robot.toml", values);
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().line, 1);
  EXPECT_TRUE(text.error().message.starts_with("not valid TOML"));
}

TEST(TransformedChannel, IsFactorTimesTheOldValuePlusOffset) {
  constexpr auto kPitch = hal::BaseChannel::pitch_rad;
  for (const char* text : {"id 0x150 byte 0 bits 24 signed little scale 1e-6",
                           "scale 0.5 id 3 offset -2 bits 16", "id 3 bits 16"}) {
    const auto before = parse_channel(text, kPitch);
    const auto after = parse_channel(transformed_channel(text, -1, 0.25), kPitch);
    ASSERT_TRUE(before && after) << transformed_channel(text, -1, 0.25);
    EXPECT_EQ((*after)->id, (*before)->id);
    EXPECT_EQ((*after)->bits, (*before)->bits);
    EXPECT_DOUBLE_EQ((*after)->scale, -(*before)->scale);
    EXPECT_DOUBLE_EQ((*after)->offset, 0.25 - (*before)->offset);
  }
}

}  // namespace
}  // namespace stilt::configuration
