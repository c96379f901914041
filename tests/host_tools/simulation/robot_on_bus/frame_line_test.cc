#include "host_tools/simulation/robot_on_bus/frame_line.h"

#include <gtest/gtest.h>

#include <bit>

namespace stilt::robot_on_bus {
namespace {

constexpr std::int64_t kNow_ns = 1'000'000'000;

hal::CanFrame numbered(std::uint32_t id) { return hal::classic_frame(id, 8); }

FrameLine line(const char* fault) { return FrameLine(std::vector{simulation::parse_fault(fault)}); }

TEST(FrameLine, FramesArriveInOrderOnTheirBus) {
  FrameLine faultless({});
  faultless.send(0, kNow_ns, {0, 1}, numbered(1));
  faultless.send(0, kNow_ns, {1, 2}, numbered(2));
  faultless.send(0, kNow_ns, {0, std::nullopt}, numbered(3));
  const std::vector<hal::CanFrame> first = faultless.arrived(kNow_ns, 0);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[0].id, 1u);
  EXPECT_EQ(first[1].id, 3u);
  ASSERT_EQ(faultless.arrived(kNow_ns, 1).size(), 1u);
  EXPECT_TRUE(faultless.arrived(kNow_ns, 0).empty());
}

TEST(FrameLine, DropLosesFramesBothWaysWhileItLasts) {
  FrameLine faulty = line("drop:knee_L@1+1");
  for (const double time_s : {0.5, 1.5, 2.5}) {
    const bool active = time_s == 1.5;
    EXPECT_EQ(faulty.lost(time_s, 0, 1), active);
    EXPECT_FALSE(faulty.lost(time_s, 0, 0)) << "another joint";
    faulty.send(time_s, kNow_ns, {0, 1}, numbered(1));
    faulty.send(time_s, kNow_ns, {0, 0}, numbered(2));
    EXPECT_EQ(faulty.arrived(kNow_ns, 0).size(), active ? 1u : 2u);
  }
}

TEST(FrameLine, DelayHoldsFramesBack) {
  FrameLine faulty = line("delay@0");
  faulty.send(0, kNow_ns, {0, 1}, numbered(1));
  EXPECT_TRUE(faulty.arrived(kNow_ns + kFrameDelay_ns - 1, 0).empty());
  EXPECT_EQ(faulty.arrived(kNow_ns + kFrameDelay_ns, 0).size(), 1u);
}

TEST(FrameLine, DuplicateDoubles) {
  FrameLine faulty = line("duplicate@0");
  faulty.send(0, kNow_ns, {0, 1}, numbered(1));
  EXPECT_EQ(faulty.arrived(kNow_ns, 0).size(), 2u);
}

TEST(FrameLine, CorruptTurnsOneBitOfEachFrameAndEveryBitInTurn) {
  FrameLine faulty = line("corrupt@0");
  std::uint64_t turned = 0;
  for (int i = 0; i < 64; ++i) faulty.send(0, kNow_ns, {0, 1}, numbered(1));
  for (const hal::CanFrame& frame : faulty.arrived(kNow_ns, 0)) {
    std::uint64_t bits = 0;
    for (std::size_t byte = 0; byte < 8; ++byte) bits |= std::uint64_t{frame.data[byte]} << 8 * byte;
    EXPECT_EQ(std::popcount(bits), 1);
    turned |= bits;
  }
  EXPECT_EQ(turned, ~std::uint64_t{0});
}

}  // namespace
}  // namespace stilt::robot_on_bus
