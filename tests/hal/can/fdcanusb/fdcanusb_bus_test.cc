#include "hal/can/fdcanusb/fdcanusb_bus.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "firmware/realtime/allocation_counter.h"
#include "hal/any_bus.h"
#include "tests/hal/can/fdcanusb/adapter_rig.h"

namespace stilt::hal::fdcanusb {
namespace {

using Fdcanusb = AdapterRig;

std::vector<CanFrame> commands(std::uint8_t value = 0) {
  std::vector<CanFrame> frames(4);
  for (std::uint32_t id = 0; id < frames.size(); ++id) {
    frames[id].id = 0x8001 + id;
    frames[id].extended = frames[id].fd = frames[id].bit_rate_switch = true;
    frames[id].length = 32;
    frames[id].data[0] = value;
  }
  return frames;
}

bool sends(FrameBus& bus, const std::vector<CanFrame>& frames) {
  return bus.send(frames).status == BusStatus::ok;
}

TEST_F(Fdcanusb, FramesGoBothWays) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  ASSERT_TRUE(sends(bus.frames(), commands()));
  ASSERT_TRUE(until([&] { return emulator.on_bus().size() == 4; }));
  EXPECT_EQ(emulator.on_bus(), commands());
  CanFrame reply = classic_frame(0x100, 8);
  CanFrame long_reply = commands(7)[3];
  emulator.deliver(reply);
  emulator.deliver(long_reply);
  std::vector<CanFrame> received;
  ASSERT_TRUE(until([&] {
    const auto some = receive_all(bus.frames());
    received.insert(received.end(), some.begin(), some.end());
    return received.size() == 2;
  }));
  EXPECT_EQ(received, (std::vector<CanFrame>{reply, long_reply}));
  const BusCounters counts = counters(bus.frames());
  EXPECT_EQ(counts.sent, 4u);
  EXPECT_EQ(counts.confirmed, 4u);
  EXPECT_EQ(counts.received, 2u);
  EXPECT_EQ(counts.malformed, 0u);
  EXPECT_EQ(bus.frames().health(), BusHealth::active);
}

TEST_F(Fdcanusb, ASecondFrameIsWithheldUntilTheFirstIsAnswered) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  ASSERT_TRUE(sends(bus.frames(), commands(1)));
  for (int tick = 0; tick < 50; ++tick) {
    const SendResult result = bus.frames().send(commands(2));
    EXPECT_EQ(result.sent, 0u);
    EXPECT_EQ(result.status, BusStatus::unconfirmed);
  }
  ASSERT_TRUE(until([&] { return counters(bus.frames()).confirmed == 4; }));
  EXPECT_TRUE(sends(bus.frames(), commands(3)));
  ASSERT_TRUE(until([&] { return emulator.on_bus().size() == 8; }));
  EXPECT_EQ(emulator.on_bus()[4].data[0], 3);
  EXPECT_EQ(counters(bus.frames()).withheld, 200u);
}

TEST_F(Fdcanusb, TheSameIdentifierTwiceInABatchGoesOnce) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  const std::vector<CanFrame> twice{commands(1)[0], commands(2)[0]};
  EXPECT_EQ(bus.frames().send(twice).sent, 1u);
}

TEST_F(Fdcanusb, ABusWithoutPoweredDriversGetsNoMoreThanOneFrameEach) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  emulator.acknowledged = false;
  ASSERT_TRUE(until([&] {
    static_cast<void>(bus.frames().send(commands()));
    return bus.frames().health() == BusHealth::passive;
  }));
  const std::uint64_t before = counters(bus.frames()).sent;
  for (int tick = 0; tick < 300; ++tick) {
    static_cast<void>(bus.frames().send(commands()));
    emulator.serve();
  }
  EXPECT_LE(counters(bus.frames()).sent, before + 4);
  // The adapter gives them up; the next ones are not acknowledged either.
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(until([&] {
      emulator.cancel();
      return emulator.queued() == 0;
    }));
    const std::uint64_t given_up = counters(bus.frames()).sent;
    ASSERT_TRUE(until([&] { return bus.frames().send(commands()).sent > 0; }));
    for (int tick = 0; tick < 50; ++tick) {
      static_cast<void>(bus.frames().send(commands()));
      emulator.serve();
    }
    EXPECT_LE(counters(bus.frames()).sent, given_up + 4);
    EXPECT_LE(emulator.queued(), 4u);
  }
  // Power returns.
  emulator.acknowledged = true;
  ASSERT_TRUE(until([&] { return sends(bus.frames(), commands(9)); }));
  ASSERT_TRUE(
      until([&] { return !emulator.on_bus().empty() && emulator.on_bus().back() == commands(9).back(); }));
  EXPECT_LE(emulator.on_bus().size(), 8u) << "at most one old frame of each";
  EXPECT_TRUE(until([&] { return bus.frames().health() != BusHealth::passive; }));
}

TEST_F(Fdcanusb, APortThatIsGoneIsOpenedAgain) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  emulator.unplug();
  ASSERT_TRUE(until([&] { return bus.frames().send(commands(1)).status == BusStatus::disconnected; }));
  std::array<CanFrame, 1> none;
  EXPECT_EQ(bus.frames().receive(none).status, BusStatus::disconnected);
  EXPECT_EQ(counters(bus.frames()).disconnections, 1u);
  EXPECT_FALSE(bus.reconnect());
  emulator.plug_in();
  EXPECT_EQ(bus.frames().send(commands(2)).status, BusStatus::disconnected) << "until reconnect()";
  ASSERT_TRUE(until([&] { return bus.reconnect(); }));
  ASSERT_TRUE(sends(bus.frames(), commands(3)));
  ASSERT_TRUE(until([&] { return emulator.on_bus().size() >= 4; }));
  EXPECT_EQ(emulator.on_bus(), commands(3)) << "nothing from before";
  EXPECT_EQ(counters(bus.frames()).disconnections, 1u);
}

/// A cable that comes off and back between two ticks.
TEST(FdcanusbLink, FramesOfAnEarlierConnectionDoNotArrive) {
  const auto link = std::make_unique<Link>();
  LinkFrames frames(*link, -1);
  std::array<CanFrame, 2> received;
  EXPECT_FALSE(frames.reconnect());
  link->connection = 1;
  ASSERT_TRUE(frames.reconnect());
  ASSERT_TRUE(link->arrivals.push(classic_frame(1, 1)));
  link->connection = 2;
  EXPECT_EQ(frames.receive(received).status, BusStatus::disconnected);
  ASSERT_TRUE(frames.reconnect());
  ASSERT_TRUE(link->arrivals.push(classic_frame(2, 1)));
  EXPECT_EQ(frames.receive(received).received, 1u);
  EXPECT_EQ(received[0].id, 2u);
  EXPECT_EQ(frames.counters().disconnections, 1u);
}

/// The thread connects anew by itself; the reset may come minutes later.
TEST(FdcanusbLink, WhatCameBeforeAResetIsNotNew) {
  const auto link = std::make_unique<Link>();
  LinkFrames frames(*link, -1);
  std::array<CanFrame, 2> received;
  link->connection = 1;
  ASSERT_TRUE(frames.reconnect());
  link->connection = 0;
  EXPECT_EQ(frames.receive(received).status, BusStatus::disconnected);
  link->connection = 2;
  for (std::size_t i = 0; i < link->arrivals.capacity(); ++i)
    ASSERT_TRUE(link->arrivals.push(classic_frame(1, 1)));
  ASSERT_TRUE(frames.reconnect());
  EXPECT_EQ(frames.receive(received).received, 0u);
  ASSERT_TRUE(link->arrivals.push(classic_frame(2, 1)));
  ASSERT_EQ(frames.receive(received).received, 1u);
  EXPECT_EQ(received[0].id, 2u);
}

TEST(FdcanusbLink, AFullRingDropsTheRestAndCountsIt) {
  const auto link = std::make_unique<Link>();
  LinkFrames frames(*link, -1);
  link->connection = 1;
  ASSERT_TRUE(frames.reconnect());
  link->settled = std::numeric_limits<std::uint64_t>::max();  // nothing is withheld
  const CanFrame frame = classic_frame(1, 1);
  const std::size_t room = link->commands.capacity();
  for (std::size_t i = 0; i < room; ++i) ASSERT_EQ(frames.send(std::span(&frame, 1)).status, BusStatus::ok);
  EXPECT_EQ(frames.send(std::span(&frame, 1)).status, BusStatus::queue_full);
  EXPECT_EQ(frames.counters().dropped_full, 1u);
  EXPECT_EQ(frames.counters().sent, room);
}

TEST(FdcanusbLink, AResetGivesUpWhatWasRefusedOften) {
  const auto link = std::make_unique<Link>();
  LinkFrames frames(*link, -1);
  link->connection = 1;
  ASSERT_TRUE(frames.reconnect());
  const CanFrame frame = classic_frame(1, 1);
  ASSERT_EQ(frames.send(std::span(&frame, 1)).sent, 1u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(frames.send(std::span(&frame, 1)).status, BusStatus::unconfirmed);
  frames.clear_bus_off();
  EXPECT_EQ(frames.send(std::span(&frame, 1)).status, BusStatus::unconfirmed);
  frames.clear_bus_off();
  EXPECT_EQ(frames.send(std::span(&frame, 1)).sent, 1u);
  EXPECT_EQ(frames.counters().echoes_lost, 1u);
  EXPECT_EQ(link->restarts.load(), 0u) << "it was not off";
}

TEST_F(Fdcanusb, AnAdapterThatAnswersNothingCountsAsGone) {
  FdcanusbBus bus;
  AdapterOptions options = patient();
  options.answer_timeout_ns = 100'000'000;
  ASSERT_EQ(open(bus, options), "");
  emulator.deaf = true;
  ASSERT_TRUE(until([&] { return bus.frames().send(commands()).status == BusStatus::disconnected; }));
  emulator.deaf = false;
  EXPECT_TRUE(until([&] { return bus.reconnect(); }));
}

TEST_F(Fdcanusb, RefusedFramesAreReportedAndBlockNothing) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  emulator.refuses_frames = true;
  ASSERT_TRUE(sends(bus.frames(), commands(1)));
  ASSERT_TRUE(until([&] { return counters(bus.frames()).error_frames == 4; }));
  EXPECT_EQ(counters(bus.frames()).confirmed, 0u);
  emulator.refuses_frames = false;
  ASSERT_TRUE(sends(bus.frames(), commands(2)));
  ASSERT_TRUE(until([&] { return emulator.on_bus().size() == 4; }));
  EXPECT_EQ(emulator.on_bus(), commands(2));
}

TEST_F(Fdcanusb, BusOffStaysUntilItIsClearedAndTheControllerIsRestarted) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  emulator.fall_off();
  ASSERT_TRUE(until([&] { return bus.frames().health() == BusHealth::off; }));
  EXPECT_EQ(counters(bus.frames()).bus_off, 1u);
  bus.frames().clear_bus_off();
  EXPECT_NE(bus.frames().health(), BusHealth::off);
  const auto& lines = emulator.lines();
  ASSERT_TRUE(until([&] { return std::ranges::find(lines, "can off") != lines.end(); }));
  ASSERT_TRUE(until([&] { return sends(bus.frames(), commands(4)); }));
  ASSERT_TRUE(until([&] { return emulator.on_bus().size() == 4; }));
  EXPECT_EQ(counters(bus.frames()).bus_off, 1u);
}

TEST_F(Fdcanusb, OldFramesAreDroppedAndCounted) {
  FdcanusbBus bus;
  AdapterOptions options = patient();
  options.stale_ns =
      -1'000'000'000'000;  // every frame is, also one handed over after the thread's look at the clock
  ASSERT_EQ(open(bus, options), "");
  ASSERT_TRUE(sends(bus.frames(), commands(1)));
  ASSERT_TRUE(until([&] { return counters(bus.frames()).dropped_full == 4; }));
  ASSERT_TRUE(until([&] { return sends(bus.frames(), commands(2)); })) << "a dropped frame is waited for";
  ASSERT_TRUE(until([&] { return counters(bus.frames()).dropped_full == 8; }));
  EXPECT_TRUE(emulator.on_bus().empty());
}

TEST_F(Fdcanusb, WhatIsNotReceivedInTimeIsDroppedAndCounted) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  constexpr std::uint64_t kRoom = 256;
  for (std::uint64_t i = 0; i < kRoom + 40; ++i)
    emulator.deliver(classic_frame(static_cast<std::uint32_t>(i), 1));
  ASSERT_TRUE(until([&] { return counters(bus.frames()).dropped_received == 40; }));
  const std::vector<CanFrame> kept = receive_all(bus.frames());
  ASSERT_EQ(kept.size(), kRoom);
  EXPECT_EQ(kept.back().id, kRoom - 1);
}

TEST_F(Fdcanusb, MoreIdentifiersThanPlacesAreWithheld) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  std::vector<CanFrame> many;
  for (std::uint32_t id = 0; id < kMaximumBatch; ++id) many.push_back(classic_frame(id, 1));
  ASSERT_TRUE(sends(bus.frames(), many));
  const CanFrame other = classic_frame(0x300, 1);
  EXPECT_EQ(bus.frames().send(std::span(&other, 1)).status, BusStatus::unconfirmed);
  many.push_back(other);
  EXPECT_EQ(bus.frames().send(many).status, BusStatus::unconfirmed);
  EXPECT_EQ(counters(bus.frames()).dropped_full, 1u) << "more than a batch";
}

TEST_F(Fdcanusb, WhatTheAdapterCannotCarryIsMalformed) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  const CanFrame empty = classic_frame(1, 0);
  EXPECT_EQ(bus.frames().send(std::span(&empty, 1)).status, BusStatus::malformed);
  emulator.write("rcv 100 0\r\n");
  EXPECT_TRUE(until([&] { return counters(bus.frames()).malformed == 2; }));
}

TEST_F(Fdcanusb, OnlyWantedIdentifiersAreReceived) {
  FdcanusbBus bus;
  AdapterOptions options = patient();
  options.receive_ids = {{0x100, false}};
  ASSERT_EQ(open(bus, options), "");
  CanFrame extended = classic_frame(0x100, 1);
  extended.extended = true;
  emulator.deliver(extended);
  emulator.deliver(classic_frame(0x101, 1));
  emulator.deliver(classic_frame(0x100, 1));
  std::vector<CanFrame> received;
  ASSERT_TRUE(until([&] {
    received = receive_all(bus.frames());
    return !received.empty();
  }));
  EXPECT_EQ(received, std::vector<CanFrame>{classic_frame(0x100, 1)});
}

TEST_F(Fdcanusb, TheTorqueLoopsCallsDoNotAllocate) {
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  const std::vector<CanFrame> frames = commands();
  std::array<CanFrame, kMaximumBatch> received;
  const realtime::AllocationScope scope;
  static_cast<void>(bus.frames().send(frames));
  static_cast<void>(bus.frames().send(frames));
  static_cast<void>(bus.frames().receive(received));
  bus.frames().clear_bus_off();
  static_cast<void>(bus.reconnect());
  EXPECT_EQ(scope.count(), 0);
}

TEST_F(Fdcanusb, ASecondProgramCannotOpenThePort) {
  FdcanusbBus first;
  ASSERT_EQ(open(first), "");
  FdcanusbBus second;
  EXPECT_NE(open(second).find("another program has it"), std::string::npos);
  EXPECT_TRUE(sends(first.frames(), commands()));
}

TEST_F(Fdcanusb, WhatCannotBeOpenedIsSaidInOneSentence) {
  const auto error = [](const std::string& path, std::int64_t timeout_ns) {
    FdcanusbBus bus;
    return bus.open(path, {.open_timeout_ns = timeout_ns}).error();
  };
  EXPECT_EQ(error("ttyACM0", 0),
            "bus fdcanusb:ttyACM0: the path of a serial port follows the colon, like "
            "fdcanusb:/dev/serial/by-id/usb-mjbots_fdcanusb_0123ABCD-if00");
  EXPECT_EQ(error("/nowhere/adapter", 0),
            "bus fdcanusb:/nowhere/adapter: serial port /nowhere/adapter: cannot be opened (No such file or "
            "directory); ls /dev/serial/by-id names those there are");
  EXPECT_EQ(error(emulator.path(), 0),
            "bus fdcanusb:" + emulator.path() +
                ": the port opens and nothing there answers `can status`; see that it "
                "is an fdcanusb");
}

TEST_F(Fdcanusb, ABusIsOpenedByItsName) {
  AnyBus bus;
  const std::string name = "fdcanusb:" + emulator.path();
  ASSERT_TRUE(bus.lock(name));
  std::atomic<bool> done = false;
  std::thread adapter([&] {
    while (!done) emulator.serve();
  });
  const auto opened = bus.open(name, {});
  done = true;
  adapter.join();
  ASSERT_TRUE(opened) << opened.error();
  EXPECT_TRUE(bus.reconnect());
  EXPECT_EQ(bus.name(), name);
  AnyBus second;
  EXPECT_FALSE(second.lock(name));
}

}  // namespace
}  // namespace stilt::hal::fdcanusb
