#include "host_tools/simulation/robot_on_bus/lockstep_exchange.h"

#include <gtest/gtest.h>

#include <deque>
#include <stdexcept>

#include "hal/can/lockstep.h"
#include "tests/host_tools/simulation/robot_on_bus/driven_robot.h"

namespace stilt::robot_on_bus {
namespace {

using hal::CanFrame;
using hal::kControllerSyncId;
using hal::kRobotSyncId;
using hal::sync_frame;
using testing_support::RobotRequest;
using testing_support::setup_of;

/// The robot's end of a bus in memory; the test is the controller.
class MemoryBus final : public hal::FrameBus {
 public:
  [[nodiscard]] hal::SendResult send(std::span<const CanFrame> frames) noexcept override {
    const std::size_t taken = std::min(frames.size(), room);
    room -= taken;
    to_controller.insert(to_controller.end(), frames.begin(),
                         frames.begin() + static_cast<std::ptrdiff_t>(taken));
    return {taken, taken < frames.size() ? hal::BusStatus::queue_full : hal::BusStatus::ok};
  }
  [[nodiscard]] hal::ReceiveResult receive(std::span<CanFrame> frames) noexcept override {
    const std::size_t count = std::min(frames.size(), to_robot.size());
    std::copy_n(to_robot.begin(), count, frames.begin());
    to_robot.erase(to_robot.begin(), to_robot.begin() + static_cast<std::ptrdiff_t>(count));
    return {count, to_robot.empty() ? hal::BusStatus::ok : hal::BusStatus::more};
  }
  [[nodiscard]] hal::BusHealth health() const noexcept override { return hal::BusHealth::active; }
  void clear_bus_off() noexcept override {}
  [[nodiscard]] const hal::BusCounters& counters() const noexcept override { return counters_; }

  std::deque<CanFrame> to_robot, to_controller;
  std::size_t room = 1000;

 private:
  hal::BusCounters counters_;
};

class LockstepExchangeTest : public testing::Test {
 protected:
  void end_turn(std::uint64_t tick) {
    for (MemoryBus& bus : buses_) bus.to_robot.push_back(sync_frame(kControllerSyncId, tick));
  }
  [[nodiscard]] static bool ends_with_sync(const MemoryBus& bus, std::uint64_t tick) {
    return !bus.to_controller.empty() && bus.to_controller.back() == sync_frame(kRobotSyncId, tick);
  }

  std::array<MemoryBus, 2> buses_;
  FrameLog log_{""};
  RobotOnBus robot_{setup_of({{"torso_sensor.rate_hz=1000"}, {}, {}, {}})};  ///< one frame per tick
  std::array<hal::FrameBus*, 2> ends_of_buses_{&buses_[0], &buses_[1]};
  BusEnds ends_{robot_, ends_of_buses_, log_};
  LockstepExchange exchange_{robot_, ends_, 0.001, [](std::size_t /*bus*/) { return 1; }};
};

TEST_F(LockstepExchangeTest, TickZeroIsAnsweredWithoutAdvancing) {
  end_turn(0);
  EXPECT_TRUE(exchange_.poll());
  EXPECT_EQ(robot_.ticks(), 0u);
  for (const MemoryBus& bus : buses_) EXPECT_TRUE(ends_with_sync(bus, 0));
}

/// A bus accepts the next controller as soon as the last one's end has been read. That may be the same poll
/// as the last one's newest turn.
TEST_F(LockstepExchangeTest, ATurnBelongsToTheControllerThatWasConnectedWhenItWasRead) {
  std::array<std::uint64_t, 2> connections{1, 1};
  LockstepExchange exchange(robot_, ends_, 0.001, [&](std::size_t bus) { return connections[bus]++; });
  end_turn(0);
  ASSERT_TRUE(exchange.poll());
  EXPECT_EQ(connections, (std::array<std::uint64_t, 2>{2, 2}));
  EXPECT_EQ(exchange.controller()[0], 1u);
  EXPECT_EQ(exchange.controller()[1], 1u);
}

TEST_F(LockstepExchangeTest, TheNextControllerMayBeginBeforeTheLastOneIsMissed) {
  std::array<std::uint64_t, 2> connections{1, 1};
  LockstepExchange exchange(robot_, ends_, 0.001, [&](std::size_t bus) { return connections[bus]; });
  end_turn(0);
  ASSERT_TRUE(exchange.poll());
  buses_[0].to_robot.push_back(sync_frame(kControllerSyncId, 1));  // and it dies
  EXPECT_FALSE(exchange.poll());
  connections[0] = 2;  // the next one has connected to the first bus and begins there
  buses_[0].to_robot.push_back(sync_frame(kControllerSyncId, 0));
  EXPECT_FALSE(exchange.poll());
  exchange.forget_controller();
  connections[1] = 2;
  buses_[1].to_robot.push_back(sync_frame(kControllerSyncId, 0));
  EXPECT_TRUE(exchange.poll());
  EXPECT_EQ(exchange.tick(), 0u);
  EXPECT_EQ(exchange.controller()[1], 2u);
}

/// A controller that was killed is missed only when the next one has connected to a bus. Its queue must have
/// room for the answer to its first turn.
TEST_F(LockstepExchangeTest, ANextControllerGetsNoFramesOfTicksWithoutAController) {
  end_turn(0);
  ASSERT_TRUE(exchange_.poll());
  for (MemoryBus& bus : buses_) bus.to_controller.clear();
  exchange_.forget_controller();
  for (int tick = 0; tick < 1000; ++tick) exchange_.advance_alone();
  EXPECT_EQ(robot_.ticks(), 1000u);
  for (const MemoryBus& bus : buses_) EXPECT_TRUE(bus.to_controller.empty()) << bus.to_controller.size();
  end_turn(0);
  ASSERT_TRUE(exchange_.poll());
  for (const MemoryBus& bus : buses_) EXPECT_EQ(bus.to_controller.size(), 1u);
}

TEST_F(LockstepExchangeTest, EachLaterTickAdvancesByOneAndEndsWithSync) {
  for (std::uint64_t tick = 0; tick < 5; ++tick) {
    end_turn(tick);
    ASSERT_TRUE(exchange_.poll());
    EXPECT_EQ(robot_.ticks(), tick);
    for (const MemoryBus& bus : buses_) EXPECT_TRUE(ends_with_sync(bus, tick));
  }
  EXPECT_EQ(buses_[0].to_controller.size(), 5u + 4u) << "syncs, and the torso sensor from tick 1 on";
}

TEST_F(LockstepExchangeTest, NothingHappensBeforeEveryBusHasEndedItsTurn) {
  end_turn(0);
  ASSERT_TRUE(exchange_.poll());
  buses_[0].to_robot.push_back(sync_frame(kControllerSyncId, 1));
  EXPECT_FALSE(exchange_.poll());
  EXPECT_EQ(robot_.ticks(), 0u);
  buses_[1].to_robot.push_back(sync_frame(kControllerSyncId, 1));
  EXPECT_TRUE(exchange_.poll());
  EXPECT_EQ(robot_.ticks(), 1u);
}

TEST_F(LockstepExchangeTest, CommandsAreAnsweredInTheirTick) {
  end_turn(0);
  ASSERT_TRUE(exchange_.poll());
  buses_[0].to_controller.clear();
  CanFrame enter = hal::classic_frame(1, 8);
  enter.data = {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfc};
  buses_[0].to_robot.push_back(enter);
  EXPECT_FALSE(exchange_.poll());
  EXPECT_TRUE(buses_[0].to_controller.empty()) << "not before the turn is over";
  end_turn(1);
  ASSERT_TRUE(exchange_.poll());
  ASSERT_EQ(buses_[0].to_controller.size(), 3u);
  EXPECT_EQ(buses_[0].to_controller[0].id, 0x11u) << "the driver's reply";
}

TEST_F(LockstepExchangeTest, AControllerThatLosesCountIsRefusedWithThatReason) {
  end_turn(0);
  ASSERT_TRUE(exchange_.poll());
  end_turn(2);
  EXPECT_THROW(exchange_.poll(), std::runtime_error);
}

TEST_F(LockstepExchangeTest, AControllerCannotBeginInTheMiddle) {
  end_turn(7);
  EXPECT_THROW(exchange_.poll(), std::runtime_error);
}

TEST_F(LockstepExchangeTest, ANewControllerBeginsAtZeroAndTheRobotsTimeGoesOn) {
  for (std::uint64_t tick = 0; tick < 4; ++tick) {
    end_turn(tick);
    ASSERT_TRUE(exchange_.poll());
  }
  exchange_.forget_controller();
  exchange_.advance_alone();
  for (std::uint64_t tick = 0; tick < 2; ++tick) {
    end_turn(tick);
    ASSERT_TRUE(exchange_.poll());
  }
  EXPECT_EQ(robot_.ticks(), 3u + 1u + 1u);
}

TEST_F(LockstepExchangeTest, AFullQueueDelaysTheTurnButLosesNothing) {
  end_turn(0);
  ASSERT_TRUE(exchange_.poll());
  end_turn(1);
  buses_[0].room = 1;
  ASSERT_TRUE(exchange_.poll());
  EXPECT_FALSE(ends_with_sync(buses_[0], 1));
  buses_[0].room = 1000;
  EXPECT_FALSE(exchange_.poll());
  EXPECT_TRUE(ends_with_sync(buses_[0], 1));
  EXPECT_EQ(buses_[0].to_controller.size(), 3u);
}

}  // namespace
}  // namespace stilt::robot_on_bus
