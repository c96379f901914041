#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "hal/can/lockstep.h"
#include "hal/loopback/loopback_client.h"
#include "host_tools/cli/robot_setup.h"
#include "host_tools/simulation/robot_on_bus/runner.h"
#include "tests/own_folder.h"

namespace stilt::robot_on_bus {
namespace {

/// An interface of the kernel shows no end of a controller; here it keeps its connections and is silent.
TEST(LockstepRunner, AControllerThatIsSilentEndsTheRunWithItsResults) {
  const tests::OwnFolder folder;
  cli::RobotOptions options;
  const std::string name = folder.path().filename().string();
  options.buses = {"loopback:" + name + ".left", "loopback:" + name + ".right"};
  options.lockstep = true;
  const cli::SimulatedHardware hardware = cli::simulated_hardware(options);
  RobotOnBus robot(hardware.setup);
  std::vector<RobotBus> buses;
  for (const std::string& bus : hardware.bus_names) buses.emplace_back(bus, hardware.fd);
  FrameLog frames("");
  RunOptions run;
  run.wait_s = 1.0;
  hal::loopback::LoopbackClient left, right;
  std::jthread controller([&] {
    for (auto [client, side] : {std::pair(&left, ".left"), std::pair(&right, ".right")}) {
      static_cast<void>(client->open(name + side, 5000));
      const hal::CanFrame sync = hal::sync_frame(hal::kControllerSyncId, 0);
      static_cast<void>(client->frames().send({&sync, 1}));
    }
  });
  const RunOutcome outcome = run_lockstep(robot, buses, frames, run);
  EXPECT_STREQ(outcome.ended, "controller silent");
  EXPECT_NEAR(robot.time_s(), 1.0, 0.01) << "alone until watchdogs have expired";
}

}  // namespace
}  // namespace stilt::robot_on_bus
