#include "hal/can/socketcan/wire_frame.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/hal/random_values.h"

namespace stilt::hal::socketcan {
namespace {

using stilt::hal::testing::RandomValues;

TEST(WireFrame, ClassicIs16BytesAndFdIs72) {
  WireFrame wire;
  EXPECT_EQ(to_wire(classic_frame(0x123, 8), wire), 16u);
  CanFrame fd;
  fd.fd = true;
  fd.length = 12;
  EXPECT_EQ(to_wire(fd, wire), 72u);
}

TEST(WireFrame, AStandardFrameHasTheBytesOfTheKernelsStructure) {
  CanFrame frame = classic_frame(0x123, 2);
  frame.data[0] = 0xab;
  frame.data[1] = 0xcd;
  WireFrame wire;
  ASSERT_EQ(to_wire(frame, wire), 16u);
  const std::array<int, 16> expected{0x23, 0x01, 0, 0, 2, 0, 0, 0, 0xab, 0xcd, 0, 0, 0, 0, 0, 0};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(std::to_integer<int>(wire[i]), expected[i]) << i;
}

TEST(WireFrame, EveryFrameThatCanExistComesBackAndNoOtherIsSent) {
  constexpr std::uint64_t kSeed = 4501;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  for (int i = 0; i < 100'000; ++i) {
    CanFrame frame = random.frame();
    WireFrame wire;
    const std::size_t bytes = to_wire(frame, wire);
    ASSERT_EQ(bytes != 0, well_formed(frame));
    if (bytes == 0) continue;
    CanFrame back;
    ASSERT_TRUE(from_wire(std::span<const std::byte>(wire).first(bytes), back));
    std::fill(frame.data.begin() + frame.length, frame.data.end(), std::uint8_t{0});
    ASSERT_EQ(back, frame);
  }
}

TEST(WireFrame, OtherSizesAndImpossibleLengthsAreRefused) {
  WireFrame wire{};
  CanFrame frame;
  for (std::size_t size = 0; size <= wire.size(); ++size) {
    const bool read = from_wire(std::span<const std::byte>(wire).first(size), frame);
    EXPECT_EQ(read, size == 16 || size == 72) << size;
  }
  wire[4] = std::byte{9};
  EXPECT_FALSE(from_wire(std::span<const std::byte>(wire).first(16), frame))
      << "nine bytes in a classic frame";
  EXPECT_FALSE(from_wire(wire, frame)) << "no FD frame has nine bytes";
}

}  // namespace
}  // namespace stilt::hal::socketcan
