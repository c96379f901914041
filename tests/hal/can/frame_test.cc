#include "hal/can/frame.h"

#include <gtest/gtest.h>

namespace stilt::hal {
namespace {

TEST(Frame, ALengthOfCanFdIsRoundedUpToTheNextThatExists) {
  EXPECT_EQ(fd_length(0), 0);
  EXPECT_EQ(fd_length(8), 8);
  EXPECT_EQ(fd_length(9), 12);
  EXPECT_EQ(fd_length(13), 16);
  EXPECT_EQ(fd_length(17), 20);
  EXPECT_EQ(fd_length(21), 24);
  EXPECT_EQ(fd_length(25), 32);
  EXPECT_EQ(fd_length(33), 48);
  EXPECT_EQ(fd_length(49), 64);
  EXPECT_EQ(fd_length(64), 64);
  EXPECT_EQ(fd_length(65), 0);
}

TEST(Frame, FramesThatNoBusCanCarryAreNotWellFormed) {
  CanFrame frame = classic_frame(0x7ff, 8);
  EXPECT_TRUE(well_formed(frame));
  frame.id = 0x800;
  EXPECT_FALSE(well_formed(frame));
  frame.extended = true;
  EXPECT_TRUE(well_formed(frame));
  frame.length = 12;
  EXPECT_FALSE(well_formed(frame)) << "classic frames have at most 8 bytes";
  frame.fd = true;
  EXPECT_TRUE(well_formed(frame));
  frame.length = 13;
  EXPECT_FALSE(well_formed(frame)) << "CAN FD has no frame of 13 bytes";
  frame.length = 16;
  frame.remote = true;
  EXPECT_FALSE(well_formed(frame)) << "CAN FD has no remote frames";
}

TEST(Frame, APayloadNeverReachesBeyondTheData) {
  CanFrame frame;
  frame.length = 200;
  EXPECT_EQ(frame.payload().size(), 64u);
}

}  // namespace
}  // namespace stilt::hal
