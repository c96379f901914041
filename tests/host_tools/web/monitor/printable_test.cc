#include "host_tools/web/monitor/printable.h"

#include <gtest/gtest.h>

namespace stilt::monitor {
namespace {

TEST(Printable, TextStaysAlsoOutsideOfAscii) {
  for (const char* text : {"", "walk at 0.30 m/s (5 %)", "gr\xc3\xbc\xc3\x9f", "\xc3\x9c",
                           "\xe2\x88\x92 1 \xc2\xb0", "\xf0\x9f\xa4\x96"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, ControlCharactersAreQuestionMarks) {
  for (char letter = 0; letter < 0x20; ++letter) EXPECT_EQ(printable(std::string(1, letter)), "?") << +letter;
  EXPECT_EQ(printable("a\x1b[2Jb\nc\x7f"), "a?[2Jb?c?");
  EXPECT_EQ(printable("\x1b]52;c;bHM=\x07"), "?]52;c;bHM=?");
}

TEST(Printable, ControlCharactersOfC1AreQuestionMarksInOneByteAndInTwo) {
  for (int code = 0x80; code < 0xa0; ++code) {
    const char byte = static_cast<char>(code);
    EXPECT_EQ(printable(std::string("a") + byte + "b"), "a?b") << code;
    EXPECT_EQ(printable(std::string("a\xc2") + byte + "b"), "a?b") << code;
  }
}

TEST(Printable, WhatIsNoUtf8IsQuestionMarks) {
  EXPECT_EQ(printable("\xc3"), "?") << "its end is missing";
  EXPECT_EQ(printable("\xc3(\xff"), "?(?");
  EXPECT_EQ(printable("\xc0\x9b"), "??") << "an escape in two bytes";
  EXPECT_EQ(printable("\xe0\x80\x9b"), "???") << "in three";
  EXPECT_EQ(printable("\xf0\x80\x80\x9b"), "????") << "in four";
}

}  // namespace
}  // namespace stilt::monitor
