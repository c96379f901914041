#include "hal/can/bus_load.h"

#include <gtest/gtest.h>

#include <array>

#include "hal/mit/mit_mode.h"
#include "hal/moteus/moteus.h"
#include "hal/odrive/odrive_cansimple.h"

namespace stilt::hal {
namespace {

constexpr BusSpeed kSpeed{1e6, 5e6};

PeriodicFrame periodic(const CanFrame& frame, double rate_hz) {
  return {frame.length, frame.extended, frame.fd, frame.bit_rate_switch, rate_hz};
}

/// Command and reply of four joints at 1 kHz on one bus.
BusLoad four_joints(const CanFrame& command, const CanFrame& reply) {
  const std::array<PeriodicFrame, 2> frames{periodic(command, 4000), periodic(reply, 4000)};
  return bus_load(frames, kSpeed);
}

TEST(BusLoad, WorstCaseBitsAreThoseOfTheLiterature) {
  // R. Davis et al. 2007: 55 + 10 n bits standard, 80 + 10 n extended.
  for (std::uint8_t n = 0; n <= 8; ++n) {
    EXPECT_EQ(worst_case_bits({.length = n}).nominal, 55u + 10u * n);
    EXPECT_EQ(worst_case_bits({.length = n, .extended = true}).nominal, 80u + 10u * n);
  }
}

TEST(BusLoad, AnFdFrameOf64BytesHasTheDataPhaseOfItsAnalysis) {
  // Data phase with stuff count: ESI 1 + DLC 4 + 512, stuff (517 + 3) / 4, count 4 + CRC 21, fixed stuff 7,
  // delimiter 1.
  const FrameBits bits = worst_case_bits({.length = 64, .fd = true, .bit_rate_switch = true});
  EXPECT_EQ(bits.data, 517u + 130u + 25u + 7u + 1u);
  EXPECT_EQ(bits.nominal, 17u + 4u + 12u);
  const FrameBits slow = worst_case_bits({.length = 64, .fd = true});
  EXPECT_EQ(slow.nominal, bits.nominal + bits.data) << "without the switch everything is at the nominal rate";
  EXPECT_EQ(slow.data, 0u);
}

TEST(BusLoad, AnFdFrameOf16BytesHasTheShortChecksumAndOneOf20TheLong) {
  // ISO 11898-1:2015: CRC-17 up to 16 bytes of data, CRC-21 beyond; a fixed stuff bit before every fourth
  // bit.
  const auto data_bits = [](std::uint8_t length) {
    return worst_case_bits({.length = length, .fd = true, .bit_rate_switch = true}).data;
  };
  EXPECT_EQ(data_bits(16), 133u + 34u + 21u + 6u + 1u);
  EXPECT_EQ(data_bits(20), 165u + 42u + 25u + 7u + 1u);
}

TEST(BusLoad, FourMitJointsDoNotFitOnOneBus) {
  CanFrame command;
  ASSERT_EQ(encode_command(mit::MitDriver{}, mit::MitCommand{}, command), EncodeStatus::ok);
  const BusLoad six_byte_replies = four_joints(command, classic_frame(0, 6));
  EXPECT_NEAR(six_byte_replies.fraction, 1.00, 1e-12);
  const BusLoad eight_byte_replies = four_joints(command, classic_frame(0, 8));
  EXPECT_NEAR(eight_byte_replies.fraction, 1.08, 1e-12);
  EXPECT_EQ(eight_byte_replies.verdict, BusLoadVerdict::refused);
}

TEST(BusLoad, FourOdriveJointsDoNotFitOnOneBus) {
  CanFrame command;
  CanFrame reply;
  ASSERT_EQ(odrive::encode_input_position(1, 0, 0, 0, command), EncodeStatus::ok);
  ASSERT_EQ(odrive::encode(1, odrive::OdriveEstimates{}, reply), EncodeStatus::ok);
  EXPECT_NEAR(four_joints(command, reply).fraction, 1.08, 1e-12);
}

TEST(BusLoad, FourMoteusJointsTake87PercentOfAnFdBus) {
  CanFrame command;
  ASSERT_EQ(encode_command(moteus::MoteusDriver{}, moteus::MoteusCommand{}, command), EncodeStatus::ok);
  CanFrame reply;
  reply.fd = reply.bit_rate_switch = true;
  reply.length = 24;
  const BusLoad load = four_joints(command, reply);
  EXPECT_NEAR(load.fraction, 0.87, 0.005);
  EXPECT_EQ(load.verdict, BusLoadVerdict::refused);
}

TEST(BusLoad, OneBusALegIsFine) {
  const std::array<PeriodicFrame, 2> frames{PeriodicFrame{.length = 8, .rate_hz = 2000},
                                            PeriodicFrame{.length = 8, .rate_hz = 2000}};
  const BusLoad load = bus_load(frames, kSpeed);
  EXPECT_NEAR(load.fraction, 0.54, 1e-12);
  EXPECT_EQ(load.verdict, BusLoadVerdict::fine);
}

TEST(BusLoad, VerdictsChangeAt60And80Percent) {
  const auto verdict = [](double rate_hz) {
    const PeriodicFrame frame{.length = 8, .rate_hz = rate_hz};  // 135 us
    return bus_load(std::span(&frame, 1), kSpeed).verdict;
  };
  EXPECT_EQ(verdict(0.599 / 135e-6), BusLoadVerdict::fine);
  EXPECT_EQ(verdict(0.601 / 135e-6), BusLoadVerdict::high);
  EXPECT_EQ(verdict(0.799 / 135e-6), BusLoadVerdict::high);
  EXPECT_EQ(verdict(0.801 / 135e-6), BusLoadVerdict::refused);
  EXPECT_EQ(bus_load({}, kSpeed).fraction, 0);
}

}  // namespace
}  // namespace stilt::hal
