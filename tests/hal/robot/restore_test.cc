#include <gtest/gtest.h>

#include <array>

#include "hal/robot/robot_hardware.h"
#include "tests/hal/robot/emulated_robot.h"

// A bus that is gone is connected again by a thread that may wait, never by the torque loop.
namespace stilt::hal {
namespace {

using testing::Kind;
using testing::Robot;

class RestoreTest : public ::testing::Test {
 protected:
  JointBusStatus read() {
    RobotReadings readings;
    hardware_.read(robot_.clock_.now_ns(), readings);
    return readings.status;
  }
  /// The other thread's turn. @return  which buses it connected
  std::vector<std::size_t> serve(bool successfully) {
    std::vector<std::size_t> connected;
    hardware_.serve_restore([&](std::size_t bus) {
      connected.push_back(bus);
      robot_.buses_[bus].set_disconnected(!successfully);
    });
    return connected;
  }

  Robot robot_{Kind::mit};
  BringUpOptions options_;
  RobotHardware hardware_{robot_.wiring_, options_,
                          std::array<FrameBus*, 2>{&robot_.buses_[0], &robot_.buses_[1]}};
};

TEST_F(RestoreTest, NothingIsConnectedUnlessABusIsGoneAndAResetWantsIt) {
  static_cast<void>(read());
  hardware_.restore_buses();
  EXPECT_TRUE(serve(true).empty());
  robot_.buses_[1].set_disconnected(true);
  EXPECT_EQ(read(), JointBusStatus::disconnected);
  EXPECT_TRUE(serve(true).empty()) << "no request yet";
  hardware_.restore_buses();
  EXPECT_EQ(serve(true), std::vector<std::size_t>{1});
  EXPECT_NE(read(), JointBusStatus::disconnected);
}

TEST_F(RestoreTest, ABusThatIsBeingRestoredIsNotUsed) {
  robot_.buses_[1].set_disconnected(true);
  static_cast<void>(read());
  const std::uint64_t errors = hardware_.errors();
  hardware_.restore_buses();
  robot_.buses_[1].set_disconnected(false);  // by housekeeping, which has not given it back yet
  robot_.buses_[1].clear_sent();
  EXPECT_EQ(read(), JointBusStatus::disconnected);
  EXPECT_EQ(hardware_.write({}), JointBusStatus::disconnected);
  EXPECT_TRUE(robot_.buses_[1].sent().empty());
  EXPECT_EQ(hardware_.errors(), errors);
  static_cast<void>(serve(true));
  EXPECT_EQ(hardware_.write({}), JointBusStatus::ok);
  EXPECT_FALSE(robot_.buses_[1].sent().empty());
}

/// A bus with counters and nothing else.
class CountingBus final : public FrameBus {
 public:
  BusCounters count;
  BusHealth condition = BusHealth::active;
  SendResult send(std::span<const CanFrame> frames) noexcept override { return {frames.size()}; }
  ReceiveResult receive(std::span<CanFrame>) noexcept override { return {}; }
  BusHealth health() const noexcept override { return condition; }
  void clear_bus_off() noexcept override {}
  const BusCounters& counters() const noexcept override { return count; }
};

TEST(RobotHardware, ErrorsAreThoseOfAllBusesAndOfEveryKind) {
  std::array<CountingBus, 2> buses;
  const Robot robot(Kind::mit);
  const RobotHardware hardware(robot.wiring_, BringUpOptions{},
                               std::array<FrameBus*, 2>{&buses[0], &buses[1]});
  EXPECT_EQ(hardware.errors(), 0u);
  buses[0].count = {};
  buses[0].count.sent = buses[0].count.received = buses[0].count.confirmed = 1000;
  EXPECT_EQ(hardware.errors(), 0u) << "traffic is no error";
  buses[0].count.dropped_full = 1;
  buses[0].count.withheld = 20;
  buses[0].count.dropped_received = 300;
  buses[0].count.malformed = 4000;
  buses[0].count.error_frames = 50000;
  EXPECT_EQ(hardware.errors(), 54321u);
  buses[1].count = buses[0].count;
  EXPECT_EQ(hardware.errors(), 2 * 54321u);
}

TEST_F(RestoreTest, BusesThatAreOffOrGoneOrErrAreNamed) {
  RobotReadings readings;
  const auto states = [&] {
    hardware_.read(robot_.clock_.now_ns(), readings);
    return readings.buses;
  };
  EXPECT_EQ(states().gone, 0);
  robot_.buses_[1].set_disconnected(true);
  EXPECT_EQ(states().gone, 0b10);
  hardware_.restore_buses();
  EXPECT_EQ(states().gone, 0b10) << "while it is connected again";
  static_cast<void>(serve(true));
  EXPECT_EQ(states().gone, 0);
}

TEST(RobotHardware, ABusErrsInTheReadAfterItsCountersRose) {
  std::array<CountingBus, 2> buses;
  const Robot robot(Kind::mit);
  RobotHardware hardware(robot.wiring_, BringUpOptions{}, std::array<FrameBus*, 2>{&buses[0], &buses[1]});
  RobotReadings readings;
  const auto states = [&] {
    hardware.read(0, readings);
    return readings.buses;
  };
  EXPECT_EQ(states().erring, 0);
  buses[1].count.error_frames = 3;
  EXPECT_EQ(states().erring, 0b10);
  EXPECT_EQ(states().erring, 0);
  buses[0].condition = BusHealth::off;
  EXPECT_EQ(states().off, 0b01);
}

/// A bus that withholds frames until a reset gives up the echoes that it waits for.
class SilencedBus final : public FrameBus {
 public:
  bool silenced = true;
  int carried = 0;
  SendResult send(std::span<const CanFrame> frames) noexcept override {
    if (silenced) return {0, BusStatus::unconfirmed};
    carried += static_cast<int>(frames.size());
    return {frames.size()};
  }
  ReceiveResult receive(std::span<CanFrame>) noexcept override { return {}; }
  BusHealth health() const noexcept override { return BusHealth::active; }
  void clear_bus_off() noexcept override { silenced = false; }
  const BusCounters& counters() const noexcept override { return counters_; }

 private:
  BusCounters counters_;
};

TEST(RobotHardware, ResetFramesOfSilentDriversLeaveABusThatLostAllEchoes) {
  std::array<SilencedBus, 2> buses;
  const Robot robot(Kind::mit);
  RobotHardware hardware(robot.wiring_, BringUpOptions{}, std::array<FrameBus*, 2>{&buses[0], &buses[1]});
  RobotReadings readings;
  for (int tick = 0; tick < 20; ++tick) hardware.read(tick, readings);
  hardware.restore_buses();
  EXPECT_EQ(buses[0].carried + buses[1].carried, 4) << "one a driver";
}

TEST_F(RestoreTest, AConnectionThatFailsIsTriedAgainWithTheNextTick) {
  robot_.buses_[0].set_disconnected(true);
  for (int tick = 0; tick < 3; ++tick) {
    EXPECT_EQ(read(), JointBusStatus::disconnected);
    hardware_.restore_buses();
    EXPECT_EQ(serve(false), std::vector<std::size_t>{0});
  }
  EXPECT_EQ(read(), JointBusStatus::disconnected);
  hardware_.restore_buses();
  static_cast<void>(serve(true));
  EXPECT_NE(read(), JointBusStatus::disconnected);
}

}  // namespace
}  // namespace stilt::hal
