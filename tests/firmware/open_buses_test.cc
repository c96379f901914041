#include "firmware/open_buses.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "hal/can/lockstep.h"
#include "hal/loopback/loopback_server.h"

namespace stilt {
namespace {

using configuration::Configuration;
using configuration::Override;

bool receives(const hal::socketcan::BusOptions& options, std::uint32_t id, bool extended) {
  return std::ranges::any_of(options.receive_ids, [=](const hal::FrameId& filter) {
    return filter.id == id && filter.extended == extended;
  });
}

TEST(OpenBuses, EachBusReceivesWhatItsDriversSendAndItsOwnCommands) {
  const Configuration configuration = configuration::load_robot("amber3m").value();
  const auto left = bus_options(configuration.hardware, 0, false);
  for (const std::uint32_t id : {0x1u, 0x2u, 0x11u, 0x12u, 0x7ffu, 0x150u}) {
    EXPECT_TRUE(receives(left, id, false)) << id;
  }
  EXPECT_FALSE(receives(left, 0x13, false)) << "on the other bus";
  EXPECT_FALSE(left.fd);
  const auto right = bus_options(configuration.hardware, 1, false);
  EXPECT_TRUE(receives(right, 0x14, false));
  EXPECT_FALSE(receives(right, 0x150, false)) << "the torso sensor is on the first bus";
}

TEST(OpenBuses, SyncFramesPassInLockstepOnly) {
  const Configuration configuration = configuration::load_robot("amber3m").value();
  EXPECT_TRUE(receives(bus_options(configuration.hardware, 1, true), hal::kRobotSyncId, true));
  EXPECT_FALSE(receives(bus_options(configuration.hardware, 1, false), hal::kRobotSyncId, true));
}

TEST(OpenBuses, MoteusDriversNeedFlexibleFramesAndBothDirections) {
  const Override moteus[] = {{"hip_driver.protocol=moteus"}, {"knee_driver.protocol=moteus"}};
  const Configuration configuration = configuration::load_robot("amber3m", moteus).value();
  const auto options = bus_options(configuration.hardware, 0, false);
  EXPECT_TRUE(options.fd);
  EXPECT_TRUE(receives(options, 0x8001, true));
  EXPECT_TRUE(receives(options, 0x100, false));
}

TEST(OpenBuses, AnInterfaceThatIsDownIsToComeUpWithTheConfiguredBitRates) {
  const Override slow[] = {{"hardware.bit_rate_bit_s=5e5"}, {"hardware.data_bit_rate_bit_s=2e6"}};
  const auto hardware = configuration::load_robot("amber3m", slow).value().hardware;
  const std::string sentence = hal::socketcan::down_sentence("can0", bus_options(hardware, 0, false));
  EXPECT_TRUE(sentence.starts_with(
      "bus can0: the interface is down; bring it up with `ip link set can0 up type can bitrate 500000`, "
      "with CAN FD also `dbitrate 2000000 fd on sample-point 0.666 "))
      << sentence;
}

/// A bus of this run alone: locks and listeners of buses are those of the machine.
std::string own_bus(const std::string& name) { return "loopback:" + name + "." + std::to_string(::getpid()); }

TEST(OpenBuses, BusesThatAnotherProgramCommandsAreNotOpened) {
  const std::string bus = own_bus("test-taken-b");
  const auto other = hal::BusLock::take(bus);
  ASSERT_TRUE(other);
  const Override taken[] = {{"hardware.buses=" + bus + "," + own_bus("test-taken-c")}};
  const auto buses = open_buses(configuration::load_robot("amber3m", taken).value().hardware, false);
  ASSERT_FALSE(buses);
  EXPECT_TRUE(buses.error().starts_with("bus " + bus + ": another stiltd")) << buses.error();
}

TEST(OpenBuses, ABusThatIsNotThereIsReportedInOneSentence) {
  const std::string bus = own_bus("test-absent-a");
  const Override absent[] = {{"hardware.buses=" + bus + "," + own_bus("test-absent-b")}};
  const Configuration configuration = configuration::load_robot("amber3m", absent).value();
  const auto buses = open_buses(configuration.hardware, false);
  ASSERT_FALSE(buses);
  EXPECT_TRUE(buses.error().starts_with("bus " + bus + ": no program listens there")) << buses.error();
}

/// A robot that listens on a bus of this name; its thread only lets the controller in.
std::vector<hal::AnyBus> connected_to(hal::loopback::LoopbackServer& robot, const std::string& name) {
  EXPECT_TRUE(robot.open(name));
  std::atomic<bool> open = false;
  std::thread lets_in([&] {
    std::array<hal::CanFrame, hal::kMaximumBatch> none;
    while (!open) {
      static_cast<void>(robot.receive(none));
      std::this_thread::yield();
    }
  });
  std::vector<hal::AnyBus> buses(1);
  EXPECT_TRUE(buses[0].open("loopback:" + name, {}));
  open = true;
  lets_in.join();
  return buses;
}

TEST(OpenBuses, ACommandThatNoDriverHasAcknowledgedIsNamedAtTheEnd) {
  hal::loopback::LoopbackServer robot;
  std::vector<hal::AnyBus> buses = connected_to(robot, "unacknowledged." + std::to_string(::getpid()));
  EXPECT_TRUE(unacknowledged(buses).empty()) << "nothing was sent";
  const hal::CanFrame commands[] = {hal::classic_frame(1, 8), hal::classic_frame(2, 8)};
  ASSERT_EQ(buses[0].frames().send(commands).sent, 2u);
  EXPECT_EQ(unacknowledged(buses), std::vector{unacknowledged_sentence(buses[0].name(), 2)});
  std::array<hal::CanFrame, hal::kMaximumBatch> taken;
  ASSERT_EQ(robot.receive(taken).received, 2u);
  EXPECT_TRUE(unacknowledged(buses).empty());
}

TEST(OpenBuses, AnInterfaceWithAnUnacknowledgedCommandIsToBeTakenDownAndUp) {
  EXPECT_EQ(unacknowledged_sentence("can0", 1),
            "bus can0: no driver has acknowledged a command; drivers get such a command when motor power "
            "returns, without stiltd; before that: `ip link set can0 down && ip link set can0 up`");
}

}  // namespace
}  // namespace stilt
