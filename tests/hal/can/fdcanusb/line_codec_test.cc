#include "hal/can/fdcanusb/line_codec.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/hal/can/fdcanusb/adapter_emulator.h"

namespace stilt::hal::fdcanusb {
namespace {

std::string command(const CanFrame& frame) {
  CommandText text;
  return {text.data(), write_command(frame, text)};
}

CanFrame fd_frame(std::uint32_t id, std::vector<std::uint8_t> bytes) {
  CanFrame frame;
  frame.id = id;
  frame.extended = id > kMaximumStandardId;
  frame.fd = frame.bit_rate_switch = true;
  frame.length = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  return frame;
}

TEST(FdcanusbLines, AFrameIsACommandWithItsFlags) {
  EXPECT_EQ(command(fd_frame(0x8001, {0x01, 0x00, 0x0a})), "can send 00008001 01000A BF\n");
  CanFrame classic = classic_frame(0x123, 2);
  classic.data[0] = 0xde;
  EXPECT_EQ(command(classic), "can send 0123 DE00 bf\n");
  CanFrame remote = classic_frame(0x7ff, 1);
  remote.remote = true;
  EXPECT_EQ(command(remote), "can send 07FF 00 bfR\n");
  CanFrame slow = fd_frame(0x1fffffff, {1});
  slow.bit_rate_switch = false;
  EXPECT_EQ(command(slow), "can send 1FFFFFFF 01 bF\n");
}

TEST(FdcanusbLines, ASmallExtendedIdentifierIsSaidToBeOne) {
  CanFrame frame = classic_frame(5, 1);
  frame.extended = true;
  EXPECT_EQ(command(frame), "can ext 0005 00 bf\n");
}

TEST(FdcanusbLines, TheLongestFrameFits) {
  const std::string line = command(fd_frame(0x1fffffff, std::vector<std::uint8_t>(64, 0xff)));
  EXPECT_EQ(line.size(), 9 + 8 + 1 + 128 + 1 + 2 + 1u);
}

TEST(FdcanusbLines, WhatTheProtocolCannotCarryIsNoCommand) {
  EXPECT_EQ(command(classic_frame(1, 0)), "") << "the adapter refuses a frame without data";
  EXPECT_EQ(command(classic_frame(0x800, 1)), "");
  CanFrame error = classic_frame(1, 8);
  error.error = true;
  EXPECT_EQ(command(error), "");
  CanFrame odd = fd_frame(1, std::vector<std::uint8_t>(12, 0));
  odd.length = 9;
  EXPECT_EQ(command(odd), "");
}

TEST(FdcanusbLines, AReceivedFrameIsRead) {
  const Line line = read_line("rcv 0100 20040a0B e B F r t123456 f1");
  ASSERT_EQ(line.kind, LineKind::received);
  CanFrame expected = fd_frame(0x100, {0x20, 0x04, 0x0a, 0x0b});
  EXPECT_EQ(line.frame, expected);
}

TEST(FdcanusbLines, FlagsThatAreHexDigitsAreNoData) {
  const Line line = read_line("rcv 7F  e b f r x-1");
  ASSERT_EQ(line.kind, LineKind::received);
  EXPECT_EQ(line.frame, classic_frame(0x7f, 0));
}

TEST(FdcanusbLines, WithoutFlagsTheKindFollowsFromSizes) {
  const Line line = read_line("rcv 8001 000102030405060708090A0B");
  ASSERT_EQ(line.kind, LineKind::received);
  EXPECT_TRUE(line.frame.extended);
  EXPECT_TRUE(line.frame.fd);
  EXPECT_EQ(line.frame.length, 12);
}

TEST(FdcanusbLines, MalformedLinesAreNoFrames) {
  for (const char* text : {"",
                           "rcv",
                           "rcv ",
                           "rcv 100 0 e b f r",
                           "rcv 100 0G e b f r",
                           "rcv XYZ 00 e b f r",
                           "rcv 800 00 e b f r",
                           "rcv 123456789 00 E",
                           "rcv 20000000 00 E",
                           "rcv 100 000102030405060708 e b F r",
                           "rcv 100 000102030405060708 e b f r",
                           "rcv 100 00 e B f r",
                           "rc 100 00",
                           "OKAY",
                           "lec=0",
                           "lec= err=0",
                           "lec=0 err=0 warn=0",
                           "lec=0 err=x warn=0 busoff=0",
                           "lec=0 err warn=0 busoff=0",
                           "\x01\x02"}) {
    EXPECT_EQ(read_line(text).kind, LineKind::malformed) << text;
  }
  const std::string long_data(130, '0');
  EXPECT_EQ(read_line("rcv 100 " + long_data + " e b F r").kind, LineKind::malformed);
}

TEST(FdcanusbLines, AnswersAreDistinguished) {
  EXPECT_EQ(read_line("OK").kind, LineKind::ok);
  EXPECT_EQ(read_line("ERR unknown flag").kind, LineKind::refused);
  EXPECT_EQ(read_line("ERR not in BusOn state").kind, LineKind::not_on);
  EXPECT_EQ(read_line("ERR already in BusOn").kind, LineKind::refused);
}

TEST(FdcanusbLines, AStatusIsRead) {
  const Line calm = read_line("lec=0 dlec=7 err=0 warn=0 busoff=0 pexc=0 tdc=19");
  ASSERT_EQ(calm.kind, LineKind::status);
  EXPECT_FALSE(calm.status.failing());
  EXPECT_FALSE(calm.status.quiet());
  const Line alone = read_line("lec=3 dlec=7 err=1 warn=1 busoff=0 pexc=0 tdc=19");
  EXPECT_TRUE(alone.status.failing());
  EXPECT_TRUE(alone.status.passive);
  EXPECT_TRUE(alone.status.warning);
  EXPECT_TRUE(read_line("lec=0 dlec=2 err=0 warn=0 busoff=0").status.failing())
      << "an error of the data phase";
  EXPECT_TRUE(read_line("lec=7 dlec=7 err=0 warn=0 busoff=1").status.off);
  EXPECT_TRUE(read_line("lec=7 dlec=7 err=0 warn=0 busoff=0").status.quiet());
}

/// Against the emulator's own writer and reader.
TEST(FdcanusbLines, EveryFrameOfABusIsReadAsItWas) {
  constexpr std::uint32_t kSeed = 20;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 2000; ++i) {
    CanFrame frame;
    frame.fd = random() % 2 == 0;
    frame.bit_rate_switch = frame.fd && random() % 2 == 0;
    frame.extended = random() % 2 == 0;
    frame.id =
        static_cast<std::uint32_t>(random()) & (frame.extended ? kMaximumExtendedId : kMaximumStandardId);
    if (random() % 4 == 0) frame.id &= 0xff;
    frame.length = fd_length(random() % (frame.fd ? 65 : 9));
    for (std::size_t byte = 0; byte < frame.length; ++byte)
      frame.data[byte] = static_cast<std::uint8_t>(random());
    const Line line = read_line(received_line(frame));
    ASSERT_EQ(line.kind, LineKind::received) << received_line(frame);
    EXPECT_EQ(line.frame, frame) << received_line(frame);
  }
}

}  // namespace
}  // namespace stilt::hal::fdcanusb
