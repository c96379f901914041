#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "hal/loopback/loopback_client.h"
#include "host_tools/cli/robot_setup.h"
#include "host_tools/simulation/robot_on_bus/runner.h"
#include "tests/own_folder.h"

namespace stilt::robot_on_bus {
namespace {

constexpr double kConnects_s = 0.1;
constexpr double kSends_s = 0.6;
constexpr double kEnds_s = 0.7;

/// A controller that is idle sends nothing; its clock runs from its connection.
TEST(RealtimeRunner, AControllerComesWhenItConnectsAndNotWithItsFirstFrame) {
  const tests::OwnFolder folder;
  cli::RobotOptions options;
  const std::string name = folder.path().filename().string();
  options.buses = {"loopback:" + name + ".left", "loopback:" + name + ".right"};
  const cli::SimulatedHardware hardware = cli::simulated_hardware(options);
  RobotOnBus robot(hardware.setup);
  std::vector<RobotBus> buses;
  for (const std::string& bus : hardware.bus_names) buses.emplace_back(bus, hardware.fd);
  FrameLog frames("");

  hal::loopback::LoopbackClient client;
  std::atomic<bool> stop = false;
  std::jthread connection;  // waits for the greeting
  bool connecting = false, sent = false;
  RunOptions run;
  run.stop = &stop;
  run.watch = [&](const RobotOnBus& watched) {  // on the runner's thread: the robot's time does not pass
    if (!connecting && watched.time_s() >= kConnects_s) {
      connecting = true;
      connection = std::jthread([&] { static_cast<void>(client.open(name + ".left", 5000)); });
    }
    if (!sent && watched.time_s() >= kSends_s) {
      sent = true;
      connection.join();
      const hal::CanFrame frame{};
      static_cast<void>(client.frames().send({&frame, 1}));
    }
    if (watched.time_s() >= kEnds_s) stop = true;
  };
  const RunOutcome outcome = run_realtime(robot, buses, frames, run);
  ASSERT_EQ(outcome.controllers_came_s.size(), 1u);
  EXPECT_GE(outcome.controllers_came_s[0], kConnects_s);
  EXPECT_LT(outcome.controllers_came_s[0], 0.5 * (kConnects_s + kSends_s));
}

}  // namespace
}  // namespace stilt::robot_on_bus
