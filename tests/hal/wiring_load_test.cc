#include "hal/wiring_load.h"

#include <gtest/gtest.h>

#include "tests/hal/emulated_robot.h"

namespace stilt::hal {
namespace {

using stilt::hal::testing::Kind;
using stilt::hal::testing::kTick_ns;
using stilt::hal::testing::Robot;

TEST(WiringLoad, OneBusALegIsFineForEveryProtocol) {
  EXPECT_NEAR(bus_load(periodic_frames(Robot(Kind::mit).wiring_, 1, 1000, 0).all(), {}).fraction, 0.54,
              1e-12);
  EXPECT_NEAR(bus_load(periodic_frames(Robot(Kind::moteus).wiring_, 1, 1000, 0).all(), {}).fraction, 0.42,
              0.005);
  EXPECT_NEAR(bus_load(periodic_frames(Robot(Kind::odrive).wiring_, 1, 1000, 0).all(), {}).fraction, 0.4706,
              0.001);
}

TEST(WiringLoad, AllFourJointsOnOneClassicBusAreRefusedInOneSentence) {
  RobotWiring wiring = Robot(Kind::mit).wiring_;
  for (JointWiring& joint : wiring.joints) joint.bus = 0;
  wiring.channel_count = 0;
  const BusLoad load = bus_load(periodic_frames(wiring, 0, 1000, 0).all(), {});
  EXPECT_EQ(load.verdict, BusLoadVerdict::refused);
  EXPECT_EQ(load_sentence("can0", load),
            "bus can0: worst-case load 108 %, above 80 %: give each leg its own bus, lower the rate of the "
            "torque loop, "
            "or use CAN FD");
  EXPECT_EQ(bus_load(periodic_frames(wiring, 0, 500, 0).all(), {}).verdict, BusLoadVerdict::fine);
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
    const PeriodicFrames frames = periodic_frames(robot.wiring_, 1, 1000, 0);
    for (const PeriodicFrame& frame : frames.all()) foreseen += frame.rate_hz;
    EXPECT_NEAR(static_cast<double>(after.sent + after.received - before.sent - before.received), foreseen,
                2);
  }
}

TEST(WiringLoad, SensorFramesCountOnceAFrame) {
  const RobotWiring wiring = Robot(Kind::mit).wiring_;  // two channels in one frame on bus 0
  const PeriodicFrames with = periodic_frames(wiring, 0, 1000, 200);
  const PeriodicFrames without = periodic_frames(wiring, 1, 1000, 200);
  ASSERT_EQ(with.count, without.count + 1);
  EXPECT_EQ(with.frames[with.count - 1].length, 4);
  EXPECT_EQ(with.frames[with.count - 1].rate_hz, 200);
}

}  // namespace
}  // namespace stilt::hal
