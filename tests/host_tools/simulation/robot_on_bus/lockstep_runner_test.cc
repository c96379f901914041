#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
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

cli::SimulatedHardware hardware_on(const std::string& name) {
  cli::RobotOptions options;
  options.buses = {"loopback:" + name + ".left", "loopback:" + name + ".right"};
  options.lockstep = true;
  return cli::simulated_hardware(options);
}

/// A robot on buses of its own, and a controller that ends its first turn on both.
class LockstepRunner : public testing::Test {
 protected:
  LockstepRunner() {
    for (const std::string& bus : hardware_.bus_names) buses_.emplace_back(bus, hardware_.fd);
  }

  void begin_controller() {
    controller_ = std::jthread([this] {
      for (std::size_t i = 0; i < clients_.size(); ++i) {
        static_cast<void>(clients_[i].open(name_ + (i == 0 ? ".left" : ".right"), 5000));
        const hal::CanFrame sync = hal::sync_frame(hal::kControllerSyncId, 0);
        static_cast<void>(clients_[i].frames().send({&sync, 1}));
      }
    });
  }
  void disconnect_controller() {
    if (controller_.joinable()) controller_.join();
    clients_.clear();
  }

  tests::OwnFolder folder_;
  std::string name_ = folder_.path().filename().string();
  cli::SimulatedHardware hardware_ = hardware_on(name_);
  RobotOnBus robot_{hardware_.setup};
  std::vector<RobotBus> buses_;
  FrameLog frames_{""};
  std::vector<hal::loopback::LoopbackClient> clients_{2};
  std::jthread controller_;
};

/// An interface of the kernel shows no end of a controller; here it keeps its connections and is silent.
TEST_F(LockstepRunner, AControllerThatIsSilentEndsTheRunWithItsResults) {
  RunOptions run;
  run.wait_s = 1.0;
  begin_controller();
  const RunOutcome outcome = run_lockstep(robot_, buses_, frames_, run);
  EXPECT_STREQ(outcome.ended, "controller silent");
  EXPECT_NEAR(robot_.time_s(), 1.0, 0.01) << "alone until watchdogs have expired";
}

/// A run that does not end by itself is interrupted.
TEST_F(LockstepRunner, ARobotWhoseControllerHasLeftWaitsForTheNextAndEndsWithoutOne) {
  std::atomic<bool> stop = false;
  const std::jthread interrupter([&stop](const std::stop_token& ended) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any never;
    never.wait_for(lock, ended, std::chrono::seconds(20), [] { return false; });
    stop = true;
  });
  RunOptions run;
  run.next_wait_s = 0.2;
  run.stop = &stop;
  run.watch = [this](const RobotOnBus&) { disconnect_controller(); };
  begin_controller();
  const RunOutcome outcome = run_lockstep(robot_, buses_, frames_, run);
  EXPECT_STREQ(outcome.ended, "no controller");
  EXPECT_NEAR(robot_.time_s(), 1.0, 0.01) << "alone once, until watchdogs have expired";
}

}  // namespace
}  // namespace stilt::robot_on_bus
