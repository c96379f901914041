#include "hal/robot/wiring_load.h"

#include <gtest/gtest.h>

#include "tests/hal/robot/emulated_robot.h"

namespace stilt::hal {
namespace {

using stilt::hal::testing::Kind;
using stilt::hal::testing::kTick_ns;
using stilt::hal::testing::Robot;

TEST(WiringLoad, OneBusALegIsFineForEveryProtocol) {
  EXPECT_NEAR(bus_load(periodic_frames(Robot(Kind::mit).wiring_, 1, 1000, 0), {}).fraction, 0.54, 1e-12);
  EXPECT_NEAR(bus_load(periodic_frames(Robot(Kind::moteus).wiring_, 1, 1000, 0), {}).fraction, 0.434, 0.005);
  EXPECT_NEAR(bus_load(periodic_frames(Robot(Kind::odrive).wiring_, 1, 1000, 0), {}).fraction, 0.5486, 0.001);
}

TEST(WiringLoad, AllFourJointsOnOneClassicBusAreRefusedInOneSentence) {
  RobotWiring wiring = Robot(Kind::mit).wiring_;
  for (JointWiring& joint : wiring.joints) joint.bus = 0;
  wiring.channel_count = 0;
  const BusLoad load = bus_load(periodic_frames(wiring, 0, 1000, 0), {});
  EXPECT_EQ(load.verdict, BusLoadVerdict::refused);
  EXPECT_EQ(
      load_sentence("can0", load),
      "bus can0: worst-case load 108 %, above 80 %: use a faster bit rate or CAN FD, put fewer drivers on "
      "this bus, or lower the rate of the torque loop");
  EXPECT_EQ(bus_load(periodic_frames(wiring, 0, 500, 0), {}).verdict, BusLoadVerdict::fine);
}

/// Frames on a bus in one second of running, and those the wiring foresees.
TEST(WiringLoad, TheFramesOfARunningRobotAreThoseForeseen) {
  for (const Kind kind : {Kind::mit, Kind::moteus, Kind::odrive}) {
    Robot robot(kind);
    JointCommands commands;
    commands.fill({.kp_Nm_rad = 10, .torque_limit_Nm = 10});
    const BusCounters before = robot.buses_[1].counters();
    for (int tick = 0; tick < 1000; ++tick) {
      ASSERT_EQ(robot.robot_->write(commands), JointBusStatus::ok);
      robot.clock_.advance(kTick_ns);
      static_cast<void>(robot.read());
    }
    const BusCounters after = robot.buses_[1].counters();
    double foreseen = 0;
    const std::vector<PeriodicFrame> frames = periodic_frames(robot.wiring_, 1, 1000, 0);
    for (const PeriodicFrame& frame : frames) foreseen += frame.rate_hz;
    EXPECT_NEAR(static_cast<double>(after.sent + after.received - before.sent - before.received), foreseen,
                2);
  }
}

TEST(WiringLoad, FramesHaveTheIdentifiersAndKindsThatTheCodecsSend) {
  RobotWiring wiring = Robot(Kind::moteus).wiring_;
  for (const std::uint8_t id :
       {std::uint8_t{7}, std::uint8_t{8}}) {  // a reply's identifier is id * 256: 0x700, 0x800
    std::get<moteus::MoteusDriver>(wiring.joints[2].driver).id = id;
    const std::vector<PeriodicFrame> frames = periodic_frames(wiring, 1, 1000, 0);
    EXPECT_TRUE(frames[0].extended) << "command";
    EXPECT_EQ(frames[1].extended, id == 8) << "reply";
    EXPECT_EQ(frames[0].length, 32);
    EXPECT_EQ(frames[1].length, 24);
  }
  const std::vector<PeriodicFrame> with_encoder = periodic_frames(wiring, 0, 1000, 0);
  EXPECT_EQ(with_encoder[1].length, 48) << "the reply of joint 0 carries the torso's encoder, too";
  wiring.channels[1].byte_offset = 10;
  const std::vector<PeriodicFrame> long_sensor = periodic_frames(wiring, 0, 1000, 200);
  EXPECT_EQ(long_sensor.back().length, 12);
  EXPECT_TRUE(long_sensor.back().fd) << "a classic frame has 8 bytes";
  wiring.channels[1].byte_offset = 6;
  const std::vector<PeriodicFrame> short_sensor = periodic_frames(wiring, 0, 1000, 200);
  EXPECT_FALSE(short_sensor.back().fd);
}

TEST(WiringLoad, SensorFramesCountOnceAFrame) {
  const RobotWiring wiring = Robot(Kind::mit).wiring_;  // two channels in one frame on bus 0
  const std::vector<PeriodicFrame> with = periodic_frames(wiring, 0, 1000, 200);
  const std::vector<PeriodicFrame> without = periodic_frames(wiring, 1, 1000, 200);
  ASSERT_EQ(with.size(), without.size() + 1);
  EXPECT_EQ(with.back().length, 4);
  EXPECT_EQ(with.back().rate_hz, 200);
}

}  // namespace
}  // namespace stilt::hal
