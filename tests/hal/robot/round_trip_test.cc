#include "hal/robot/round_trip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "hal/robot/tap_bus.h"
#include "tests/hal/robot/emulated_robot.h"

namespace stilt::hal {
namespace {

using testing::Kind;
using testing::kTick_ns;
using testing::Robot;

/// Emulated drivers behind taps.
class TappedRobot {
 public:
  explicit TappedRobot(Kind kind) : robot(kind) {
    for (std::size_t bus = 0; bus < 2; ++bus) taps[bus].attach(robot.buses_[bus]);
    const std::array<FrameBus*, 2> pointers{&taps[0], &taps[1]};
    joints = std::make_unique<CanRobot>(robot.wiring_, pointers);
  }
  Robot robot;
  std::array<TapBus, 2> taps;
  std::unique_ptr<CanRobot> joints;
};

TEST(RoundTrip, IsOverWhenEveryDriverHasReplied) {
  for (const Kind kind : {Kind::mit, Kind::moteus}) {
    TappedRobot tapped(kind);
    RoundTrip meter(tapped.robot.wiring_, tapped.taps);
    const mock::FaultRule late{.fault = mock::FrameFault::delay,
                               .id = tapped.robot.frame_ids_[3],
                               .any_id = false,
                               .delay_ns = 200'000};
    tapped.robot.buses_[1].add_fault(late);
    JointReadings readings;
    static_cast<void>(tapped.joints->read(tapped.robot.clock_.now_ns(), readings));
    const std::int64_t sent_ns = tapped.robot.clock_.now_ns();
    ASSERT_EQ(tapped.joints->write({}), JointBusStatus::ok);
    const std::int64_t took_ns = meter.measure(tapped.robot.clock_, sent_ns, sent_ns + kTick_ns);
    EXPECT_GE(took_ns, 200'000);
    EXPECT_LE(took_ns, 220'000);
    EXPECT_EQ(tapped.joints->read(tapped.robot.clock_.now_ns(), readings), JointBusStatus::ok)
        << "what was listened to is still received";
  }
}

TEST(RoundTrip, AReplyOnAnotherBusIsNotTheDrivers) {
  TappedRobot tapped(Kind::mit);
  // The frame of the missing driver comes, with all identifiers alike on both buses.
  tapped.robot.drivers_[3]->set_powered(false);
  RoundTrip meter(tapped.robot.wiring_, tapped.taps);
  const std::int64_t sent_ns = tapped.robot.clock_.now_ns();
  ASSERT_EQ(tapped.robot.frame_ids_[1], tapped.robot.frame_ids_[3]);
  static_cast<void>(tapped.joints->write({}));
  EXPECT_EQ(meter.measure(tapped.robot.clock_, sent_ns, sent_ns + kTick_ns), -1);
}

TEST(RoundTrip, EachReplyIsAwaitedOnItsOwnBusAlone) {
  Robot robot(Kind::mit);
  // Identifiers of their own on the second bus, and drivers to them.
  std::array<std::shared_ptr<mit::MitEmulator>, 2> drivers;
  mock::MockBus second(robot.clock_);
  for (std::size_t joint = 2; joint < kJoints; ++joint) {
    auto& driver = std::get<mit::MitDriver>(robot.wiring_.joints[joint].driver);
    driver.command_id = static_cast<std::uint16_t>(joint + 1);
    driver.driver_id = static_cast<std::uint8_t>(joint + 1);
    driver.reply_id = static_cast<std::uint16_t>(0x10 + driver.command_id);
    drivers[joint - 2] = std::make_shared<mit::MitEmulator>(mit::make_emulator(driver));
    second.attach(*drivers[joint - 2]);
  }
  std::array<TapBus, 2> taps;
  taps[0].attach(robot.buses_[0]);
  taps[1].attach(second);
  const std::array<FrameBus*, 2> pointers{&taps[0], &taps[1]};
  CanRobot joints(robot.wiring_, pointers);
  RoundTrip meter(robot.wiring_, taps);
  const std::int64_t sent_ns = robot.clock_.now_ns();
  ASSERT_EQ(joints.write({}), JointBusStatus::ok);
  EXPECT_EQ(meter.measure(robot.clock_, sent_ns, sent_ns + kTick_ns), 0) << "all have replied at once";
}

/// Two AK that answer with identifier 0, as their firmware may. The second one loses 5 of 1000 replies.
TEST(RoundTrip, AReplyIsThatOfOneDriverWhereSeveralShareAnIdentifier) {
  for (const auto layout : {mit::ReplyLayout::ak, mit::ReplyLayout::damiao}) {
    mock::MockClock clock;
    mock::MockBus bus(clock);
    RobotWiring wiring;
    std::array<std::shared_ptr<mit::MitEmulator>, kJoints> drivers;
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      mit::MitDriver driver;
      driver.command_id = static_cast<std::uint16_t>(joint + 1);
      driver.driver_id = static_cast<std::uint8_t>(joint + 1);
      driver.reply_id = 0;
      driver.layout = layout;
      wiring.joints[joint].driver = driver;
      drivers[joint] = std::make_shared<mit::MitEmulator>(mit::make_emulator(driver));
      bus.attach(*drivers[joint]);
    }
    TapBus tap;
    tap.attach(bus);
    const std::array<ReplyFrame, kJoints> replies = reply_frames(wiring);
    RoundTrip meter(wiring, std::span(&tap, 1));
    std::array<long, kJoints> answered{};
    for (int tick = 0; tick < 1000; ++tick) {
      const bool loses = tick % 200 == 0;
      drivers[1]->set_powered(!loses);
      for (const JointWiring& joint : wiring.joints) {
        CanFrame command;
        ASSERT_EQ(encode_command(std::get<mit::MitDriver>(joint.driver), {}, command), EncodeStatus::ok);
        ASSERT_EQ(tap.send(std::span(&command, 1)).sent, 1u);
      }
      const std::int64_t sent_ns = clock.now_ns();
      EXPECT_EQ(meter.measure(clock, sent_ns, sent_ns + kTick_ns / 2) < 0, loses) << tick;
      std::array<CanFrame, kMaximumBatch> received;
      while (tap.receive(received).status == BusStatus::more) continue;
      for (std::size_t joint = 0; joint < kJoints; ++joint) {
        answered[joint] += std::ranges::count_if(
            tap.kept(), [&](const CanFrame& frame) { return replies[joint].is(frame); });
      }
      tap.forget();
      clock.advance(kTick_ns);
    }
    EXPECT_EQ(answered, (std::array<long, kJoints>{1000, 995, 1000, 1000}));
  }
}

TEST(RoundTrip, GivesUpInTime) {
  TappedRobot tapped(Kind::mit);
  RoundTrip meter(tapped.robot.wiring_, tapped.taps);
  tapped.robot.drivers_[0]->set_powered(false);
  const std::int64_t sent_ns = tapped.robot.clock_.now_ns();
  static_cast<void>(tapped.joints->write({}));
  EXPECT_EQ(meter.measure(tapped.robot.clock_, sent_ns, sent_ns + 500'000), -1);
  EXPECT_LE(tapped.robot.clock_.now_ns(), sent_ns + 500'000);
}

TEST(RoundTrip, TheNewestMeasurementStaysWhileTheBusIsMute) {
  TappedRobot tapped(Kind::mit);
  RoundTrip meter(tapped.robot.wiring_, tapped.taps);
  EXPECT_EQ(meter.newest_ns(), 0);
  const auto measure = [&] {
    JointReadings readings;
    static_cast<void>(tapped.joints->read(tapped.robot.clock_.now_ns(), readings));
    const std::int64_t sent_ns = tapped.robot.clock_.now_ns() - 1'000;
    static_cast<void>(tapped.joints->write({}));
    return meter.measure(tapped.robot.clock_, sent_ns, sent_ns + kTick_ns);
  };
  EXPECT_EQ(measure(), 1'000);
  for (const auto& driver : tapped.robot.drivers_) driver->set_powered(false);
  EXPECT_EQ(measure(), -1);
  EXPECT_EQ(meter.newest_ns(), 1'000);
}

TEST(RoundTrip, DoesNotWaitForDriversThatDoNotReply) {
  TappedRobot tapped(Kind::odrive);
  RoundTrip meter(tapped.robot.wiring_, tapped.taps);
  const std::int64_t now_ns = tapped.robot.clock_.now_ns();
  EXPECT_EQ(meter.measure(tapped.robot.clock_, now_ns, now_ns + kTick_ns), -1);
  EXPECT_EQ(tapped.robot.clock_.now_ns(), now_ns);
}

TEST(TapBus, WhatWasListenedToOnALostConnectionNeverComes) {
  mock::MockClock clock;
  mock::MockBus bus(clock);
  TapBus tap;
  tap.attach(bus);
  bus.script(classic_frame(1, 1), clock.now_ns());
  ASSERT_EQ(tap.listen().size(), 1u);
  bus.set_disconnected(true);
  const CanFrame command = classic_frame(2, 1);
  ASSERT_EQ(tap.send(std::span(&command, 1)).status, BusStatus::disconnected);
  tap.begin_reconnect();
  ASSERT_TRUE(tap.reconnecting());
  bus.set_disconnected(false);
  tap.end_reconnect();
  std::array<CanFrame, 2> two;
  EXPECT_EQ(tap.receive(two).received, 0u);
}

TEST(TapBus, WhatWasListenedToComesFirstAndInOrder) {
  mock::MockClock clock;
  mock::MockBus bus(clock);
  TapBus tap;
  tap.attach(bus);
  for (const std::uint32_t id : {1u, 2u, 3u}) bus.script(classic_frame(id, 1), clock.now_ns());
  EXPECT_EQ(tap.listen().size(), 3u);
  bus.script(classic_frame(4, 1), clock.now_ns());
  std::array<CanFrame, 2> two;
  std::vector<std::uint32_t> ids;
  while (true) {
    const ReceiveResult result = tap.receive(two);
    for (const CanFrame& frame : std::span(two).first(result.received)) ids.push_back(frame.id);
    if (result.status != BusStatus::more) break;
  }
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{1, 2, 3, 4}));
  EXPECT_EQ(tap.kept().size(), 4u);
}

}  // namespace
}  // namespace stilt::hal
