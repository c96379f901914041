#include "hal/exchange/ring.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace stilt::exchange {
namespace {

TEST(Ring, ElementsComeOutInTheOrderTheyWentIn) {
  Ring<int, 4> ring;
  EXPECT_EQ(ring.front(), nullptr);
  for (int round = 0; round < 3; ++round) {
    for (int value : {1, 2, 3}) EXPECT_TRUE(ring.push(10 * round + value));
    for (int value : {1, 2, 3}) {
      const int* element = ring.front();
      ASSERT_NE(element, nullptr);
      EXPECT_EQ(*element, 10 * round + value);
      ring.pop();
    }
    EXPECT_EQ(ring.front(), nullptr);
  }
}

TEST(Ring, WhenFullTheNewElementIsDroppedAndCounted) {
  Ring<int, 4> ring;
  for (int value = 0; value < 4; ++value) EXPECT_TRUE(ring.push(value));
  EXPECT_FALSE(ring.push(4));
  EXPECT_EQ(ring.claim(), nullptr);
  EXPECT_EQ(ring.dropped(), 2u);
  EXPECT_EQ(*ring.front(), 0) << "the old ones stay";
  ring.pop();
  EXPECT_TRUE(ring.push(5));
  EXPECT_EQ(ring.dropped(), 2u);
}

TEST(Ring, PlacesThatAreSparedStayFreeForOtherElements) {
  Ring<int, 4> ring;
  for (int value = 0; value < 2; ++value) EXPECT_TRUE(ring.push(value, 2));
  EXPECT_FALSE(ring.push(2, 2));
  EXPECT_EQ(ring.dropped(), 1u);
  for (int value = 3; value < 5; ++value) EXPECT_TRUE(ring.push(value));
  EXPECT_FALSE(ring.push(5, 2)) << "more than half full";
  EXPECT_FALSE(ring.push(6));
}

TEST(Ring, AnElementIsFilledInPlace) {
  Ring<int, 2> ring;
  int* slot = ring.claim();
  ASSERT_NE(slot, nullptr);
  *slot = 9;
  EXPECT_EQ(ring.front(), nullptr) << "not there before commit";
  ring.commit();
  ASSERT_NE(ring.front(), nullptr);
  EXPECT_EQ(*ring.front(), 9);
}

TEST(Ring, BetweenThreadsNothingIsTornDoubledOrUncounted) {
  constexpr std::uint64_t kElements = 100'000;
  using Block = std::array<std::uint64_t, 16>;
  Ring<Block, 64> ring;
  std::thread producer([&ring] {
    for (std::uint64_t value = 1; value <= kElements; ++value) {
      if (Block* block = ring.claim()) {
        block->fill(value);
        ring.commit();
      }
    }
    Block end;
    end.fill(kElements + 1);
    while (!ring.push(end)) std::this_thread::yield();
  });
  std::uint64_t last = 0;
  std::uint64_t received = 0;
  std::uint64_t wrong = 0;
  while (last != kElements + 1) {
    const Block* block = ring.front();
    if (block == nullptr) continue;
    for (const std::uint64_t number : *block) wrong += number != (*block)[0] ? 1 : 0;
    wrong += (*block)[0] <= last ? 1 : 0;
    last = (*block)[0];
    ++received;
    ring.pop();
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_GE(received + ring.dropped(), kElements + 1) << "the last one may have been tried more than once";
}

}  // namespace
}  // namespace stilt::exchange
