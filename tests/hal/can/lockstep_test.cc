#include "hal/can/lockstep.h"

#include <gtest/gtest.h>

#include "tests/hal/hex.h"

namespace stilt::hal {
namespace {

using stilt::hal::testing::hex;

constexpr std::uint64_t kTick = 0x0123456789abcdef;

TEST(Lockstep, TheTickIsLittleEndianUnderAnExtendedIdentifier) {
  const CanFrame frame = sync_frame(kControllerSyncId, kTick);
  EXPECT_EQ(frame.id, 0x1ffffff0u);
  EXPECT_TRUE(frame.extended);
  EXPECT_TRUE(well_formed(frame));
  EXPECT_EQ(hex(frame), "efcdab8967452301");
  EXPECT_EQ(sync_frame(kRobotSyncId, 1).id, 0x1ffffff1u);
}

TEST(Lockstep, TheTickComesBack) {
  for (const std::uint64_t tick : {std::uint64_t{0}, std::uint64_t{1}, kTick, ~std::uint64_t{0}}) {
    std::uint64_t read = 7;
    ASSERT_EQ(decode_sync(kRobotSyncId, sync_frame(kRobotSyncId, tick), read), DecodeStatus::ok);
    EXPECT_EQ(read, tick);
  }
}

TEST(Lockstep, OneSideDoesNotTakeItsOwnFrameForTheOthers) {
  std::uint64_t tick = 7;
  EXPECT_EQ(decode_sync(kRobotSyncId, sync_frame(kControllerSyncId, 3), tick), DecodeStatus::not_addressed);
  EXPECT_EQ(tick, 7u);
}

TEST(Lockstep, FramesThatOnlyLookAlikeAreRefused) {
  std::uint64_t tick = 7;
  CanFrame shorter = sync_frame(kRobotSyncId, 3);
  shorter.length = 7;
  EXPECT_EQ(decode_sync(kRobotSyncId, shorter, tick), DecodeStatus::wrong_length);
  CanFrame standard = sync_frame(kRobotSyncId, 3);
  standard.extended = false;
  EXPECT_EQ(decode_sync(kRobotSyncId, standard, tick), DecodeStatus::not_addressed);
  CanFrame remote = sync_frame(kRobotSyncId, 3);
  remote.remote = true;
  EXPECT_EQ(decode_sync(kRobotSyncId, remote, tick), DecodeStatus::not_addressed);
  EXPECT_EQ(tick, 7u);
}

}  // namespace
}  // namespace stilt::hal
