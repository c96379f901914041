#include "hal/robot/flexible_frames.h"

#include <gtest/gtest.h>

#include <array>

#include "hal/robot/tap_bus.h"
#include "hal/robot/wiring_load.h"
#include "tests/hal/robot/emulated_robot.h"

namespace stilt::hal {
namespace {

using stilt::hal::testing::Kind;
using stilt::hal::testing::Robot;

RobotWiring with_can_fd(Kind kind) {
  RobotWiring wiring = Robot(kind).wiring_;
  for (JointWiring& joint : wiring.joints) joint.can_fd = true;
  return wiring;
}

CanFrame flexible(CanFrame frame) {
  frame.fd = frame.bit_rate_switch = true;
  return frame;
}

TEST(FlexibleFrames, OfADamiaoAreItsCommandsRepliesAndRegisters) {
  RobotWiring wiring = with_can_fd(Kind::mit);
  auto& driver = std::get<mit::MitDriver>(wiring.joints[0].driver);
  driver.layout = mit::ReplyLayout::damiao;
  const FlexibleFrames frames(wiring, wiring.joints[0].bus);
  for (const std::uint32_t id : {std::uint32_t{driver.command_id}, std::uint32_t{driver.reply_id}, 0x7ffu}) {
    EXPECT_EQ(frames.to_bus(classic_frame(id, 8)), flexible(classic_frame(id, 8))) << id;
    EXPECT_EQ(frames.from_bus(flexible(classic_frame(id, 8))), classic_frame(id, 8)) << id;
  }
}

TEST(FlexibleFrames, OfAnOdriveAreThoseOfItsNodeButRemoteOnes) {
  const RobotWiring wiring = with_can_fd(Kind::odrive);
  const std::uint32_t node = std::get<odrive::OdriveDriver>(wiring.joints[0].driver).node;
  const FlexibleFrames frames(wiring, wiring.joints[0].bus);
  EXPECT_TRUE(frames.to_bus(classic_frame(node << 5 | 0x1f, 8)).fd);
  CanFrame remote = classic_frame(node << 5 | 1, 8);
  remote.remote = true;
  EXPECT_EQ(frames.to_bus(remote), remote) << "CAN FD has none";
}

TEST(FlexibleFrames, OtherFramesStayAsTheyAre) {
  const RobotWiring wiring = with_can_fd(Kind::mit);
  const auto& driver = std::get<mit::MitDriver>(wiring.joints[0].driver);
  const FlexibleFrames frames(wiring, wiring.joints[0].bus);
  EXPECT_EQ(frames.to_bus(classic_frame(0x150, 6)), classic_frame(0x150, 6)) << "of a sensor";
  CanFrame extended = classic_frame(driver.command_id, 8);
  extended.extended = true;
  EXPECT_EQ(frames.to_bus(extended), extended);
  const CanFrame classic = classic_frame(driver.reply_id, 8);
  EXPECT_EQ(frames.from_bus(classic), classic) << "a driver may answer with either";
  CanFrame longer = flexible(classic);
  longer.length = 12;
  EXPECT_EQ(frames.from_bus(longer), longer) << "no frame of the protocol";
  EXPECT_TRUE(FlexibleFrames(Robot(Kind::mit).wiring_, 0).empty()) << "without can_fd";
  EXPECT_TRUE(FlexibleFrames(with_can_fd(Kind::moteus), 0).empty()) << "a moteus has them anyway";
  EXPECT_TRUE(FlexibleFrames(wiring, 3).empty()) << "on a bus without drivers";
}

TEST(FlexibleFrames, WithoutBitRateSwitchHaveOneRate) {
  RobotWiring wiring = with_can_fd(Kind::mit);
  for (JointWiring& joint : wiring.joints) joint.bit_rate_switch = false;
  const auto& driver = std::get<mit::MitDriver>(wiring.joints[0].driver);
  const CanFrame frame =
      FlexibleFrames(wiring, wiring.joints[0].bus).to_bus(classic_frame(driver.command_id, 8));
  EXPECT_TRUE(frame.fd);
  EXPECT_FALSE(frame.bit_rate_switch);
}

TEST(FlexibleFrames, AreTurnedInTheTapBothWays) {
  const RobotWiring wiring = with_can_fd(Kind::mit);
  const auto& driver = std::get<mit::MitDriver>(wiring.joints[0].driver);
  const std::size_t number = wiring.joints[0].bus;
  mock::MockClock clock;
  mock::MockBus bus(clock);
  TapBus tap;
  tap.attach(bus, FlexibleFrames(wiring, number));
  const std::array sent{classic_frame(driver.command_id, 8), classic_frame(0x080, 0)};
  ASSERT_EQ(tap.send(sent).sent, 2u);
  ASSERT_EQ(bus.sent().size(), 2u);
  EXPECT_EQ(bus.sent()[0], flexible(sent[0]));
  EXPECT_EQ(bus.sent()[1], sent[1]);
  bus.script(flexible(classic_frame(driver.reply_id, 8)), clock.now_ns());
  std::array<CanFrame, 4> received;
  ASSERT_EQ(tap.receive(received).received, 1u);
  EXPECT_EQ(received[0], classic_frame(driver.reply_id, 8));
  EXPECT_EQ(tap.kept()[0], received[0]) << "as bring-up reads it";
  bus.script(flexible(classic_frame(driver.reply_id, 8)), clock.now_ns());
  ASSERT_EQ(tap.listen().size(), 1u);
  EXPECT_FALSE(tap.listen()[0].fd);
}

/// Four drivers have no place on one classic bus at 1000 ticks per second.
TEST(FlexibleFrames, LetFourDriversShareABus) {
  RobotWiring wiring = with_can_fd(Kind::mit);
  for (JointWiring& joint : wiring.joints) joint.bus = 0;
  wiring.channel_count = 0;
  EXPECT_TRUE(uses_fd(wiring, 0));
  EXPECT_EQ(bus_load(periodic_frames(wiring, 0, 1000, 0), {}).verdict, BusLoadVerdict::fine);
}

}  // namespace
}  // namespace stilt::hal
