#include "hal/robot/driver_zero.h"

#include <gtest/gtest.h>

#include "hal/moteus/moteus_driver.h"
#include "hal/moteus/moteus_emulator.h"

// What a driver keeps of a zero. Every protocol: tests/firmware/commissioning/zero_test.cc
namespace stilt::hal {
namespace {

/// Position by a query.
double position_rad(const moteus::MoteusDriver& driver, moteus::MoteusEmulator& emulator) {
  CanFrame question;
  FrameSink replies;
  EXPECT_EQ(encode_query(driver, moteus::MoteusQuery::state, question), EncodeStatus::ok);
  emulator.take(1'000'000'000, question, replies);
  moteus::MoteusReply reply;
  if (replies.frames().empty() || decode_reply(driver, replies.frames()[0], reply) != DecodeStatus::ok) {
    return 1e9;
  }
  return reply.position_rad;
}

TEST(DriverZero, OfAMoteusIsWrittenAndStaysWithoutPower) {
  const moteus::MoteusDriver driver;
  moteus::MoteusEmulator emulator(driver);
  emulator.motor.position_rad = 0.5;
  EXPECT_NEAR(position_rad(driver, emulator), 0.5, 1e-4);
  moteus::MoteusZero zero(driver);
  ZeroProgress progress = ZeroProgress::more;
  for (int frame = 0; frame < 100 && progress != ZeroProgress::done; ++frame) {
    FrameSink replies;
    emulator.take(1'000'000 * (frame + 1), zero.next(false), replies);
    for (const CanFrame& reply : replies.frames()) progress = zero.take(reply);
    ASSERT_NE(progress, ZeroProgress::failed);
  }
  EXPECT_EQ(progress, ZeroProgress::done);
  EXPECT_NEAR(position_rad(driver, emulator), 0.0, 1e-4);
  emulator.power_cycle();
  EXPECT_NEAR(position_rad(driver, emulator), 0.0, 1e-4);
}

TEST(DriverZero, AnOdriveHasNone) {
  EXPECT_FALSE(make_zero(odrive::OdriveDriver{}));
  EXPECT_TRUE(make_zero(mit::MitDriver{}));
}

}  // namespace
}  // namespace stilt::hal
