#include "firmware/exchange/latest_value.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace stilt::exchange {
namespace {

TEST(LatestValue, BeforeTheFirstPublicationTheValueIsTheDefaultAndNoNews) {
  LatestValue<int> slot;
  EXPECT_FALSE(slot.has_news());
  EXPECT_EQ(slot.newest(), 0);
}

TEST(LatestValue, OnlyTheNewestOfSeveralValuesIsRead) {
  LatestValue<int> slot;
  for (int value : {1, 2, 3, 4, 5}) {
    slot.writer() = value;
    slot.publish();
  }
  EXPECT_TRUE(slot.has_news());
  EXPECT_EQ(slot.newest(), 5);
  EXPECT_FALSE(slot.has_news());
  EXPECT_EQ(slot.newest(), 5) << "and stays when nothing newer comes";
}

TEST(LatestValue, WhatTheReaderHoldsStaysWhileTheWriterGoesOn) {
  LatestValue<int> slot;
  slot.writer() = 1;
  slot.publish();
  const int& held = slot.newest();
  for (int value : {2, 3, 4}) {
    slot.writer() = value;
    EXPECT_EQ(held, 1);
    slot.publish();
    EXPECT_EQ(held, 1);
  }
  EXPECT_EQ(slot.newest(), 4);
}

TEST(LatestValue, ThreadsSeeWholeValuesInOrderAndTheLastOne) {
  constexpr std::uint64_t kLast = 100'000;
  using Block = std::array<std::uint64_t, 32>;
  LatestValue<Block> slot;
  std::thread writer([&slot] {
    for (std::uint64_t value = 1; value <= kLast; ++value) {
      slot.writer().fill(value);
      slot.publish();
    }
  });
  std::uint64_t last = 0;
  std::uint64_t torn = 0;
  std::uint64_t backwards = 0;
  while (last != kLast) {
    const Block& block = slot.newest();
    for (const std::uint64_t number : block) torn += number != block[0] ? 1 : 0;
    backwards += block[0] < last ? 1 : 0;
    last = block[0];
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(backwards, 0u);
}

}  // namespace
}  // namespace stilt::exchange
