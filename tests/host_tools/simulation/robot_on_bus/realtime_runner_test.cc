#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <optional>
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
constexpr double kSoon_s = 15.0;  // half of the longest wait for a controller to end

cli::SimulatedHardware hardware_on(const std::string& name) {
  cli::RobotOptions options;
  options.buses = {"loopback:" + name + ".left", "loopback:" + name + ".right"};
  return cli::simulated_hardware(options);
}

/// A robot on buses of its own, and a controller that connects to the first of them.
class RealtimeRunner : public testing::Test {
 protected:
  RealtimeRunner() {
    for (const std::string& bus : hardware_.bus_names) buses_.emplace_back(bus, hardware_.fd);
  }

  /// Once the robot has come to that time; the connection waits for the greeting.
  void connect_at(double time_s) {
    at(time_s, [this] {
      connection_ = std::jthread([this] { static_cast<void>(client_->open(name_ + ".left", 5000)); });
    });
  }
  [[nodiscard]] hal::loopback::LoopbackClient& connected() {
    if (connection_.joinable()) connection_.join();
    return *client_;
  }
  /// On the runner's thread: the robot's time does not pass.
  void at(double time_s, std::function<void()> act) { acts_.push_back({time_s, std::move(act)}); }

  RunOutcome run(RunOptions options = {}) {
    options.stop = &stop_;
    options.stop_after_controller = &stop_after_controller_;
    options.watch = [this](const RobotOnBus& watched) {
      while (next_ < acts_.size() && watched.time_s() >= acts_[next_].time_s) acts_[next_++].act();
    };
    return run_realtime(robot_, buses_, frames_, options);
  }

  struct Act {
    double time_s;
    std::function<void()> act;
  };

  tests::OwnFolder folder_;
  std::string name_ = folder_.path().filename().string();
  cli::SimulatedHardware hardware_ = hardware_on(name_);
  RobotOnBus robot_{hardware_.setup};
  std::vector<RobotBus> buses_;
  FrameLog frames_{""};
  std::optional<hal::loopback::LoopbackClient> client_{std::in_place};
  std::atomic<bool> stop_ = false, stop_after_controller_ = false;
  std::vector<Act> acts_;
  std::size_t next_ = 0;
  std::jthread connection_;
};

/// A controller that is idle sends nothing; its clock runs from its connection.
TEST_F(RealtimeRunner, AControllerComesWhenItConnectsAndNotWithItsFirstFrame) {
  connect_at(kConnects_s);
  at(kSends_s, [this] {
    const hal::CanFrame frame{};
    static_cast<void>(connected().frames().send({&frame, 1}));
  });
  at(kEnds_s, [this] { stop_ = true; });
  const RunOutcome outcome = run();
  ASSERT_EQ(outcome.controllers_came_s.size(), 1u);
  EXPECT_GE(outcome.controllers_came_s[0], kConnects_s);
  EXPECT_LT(outcome.controllers_came_s[0], 0.5 * (kConnects_s + kSends_s));
}

/// It sits the robot down first, also after one Ctrl-C for both.
TEST_F(RealtimeRunner, ARunThatIsAskedToEndWaitsForItsControllerToEnd) {
  connect_at(kConnects_s);
  at(kSends_s, [this] {
    static_cast<void>(connected());
    stop_after_controller_ = true;
  });
  at(kEnds_s, [this] { client_.reset(); });
  EXPECT_STREQ(run().ended, "interrupted");
  EXPECT_GE(robot_.time_s(), kEnds_s);
  EXPECT_LT(robot_.time_s(), kSoon_s);
}

TEST_F(RealtimeRunner, ARunThatIsAskedToEndAtOnceWaitsForNoController) {
  connect_at(kConnects_s);
  at(kSends_s, [this] {
    static_cast<void>(connected());
    stop_after_controller_ = true;
  });
  at(kEnds_s, [this] { stop_ = true; });
  EXPECT_STREQ(run().ended, "interrupted");
  EXPECT_LT(robot_.time_s(), kSoon_s);
}

TEST_F(RealtimeRunner, ARunWithoutAControllerThatIsAskedToEndEnds) {
  at(kConnects_s, [this] { stop_after_controller_ = true; });
  EXPECT_STREQ(run().ended, "interrupted");
  EXPECT_LT(robot_.time_s(), kSoon_s);
}

TEST_F(RealtimeRunner, AControllerThatDoesNotEndIsNotWaitedForWithoutEnd) {
  connect_at(kConnects_s);
  at(kSends_s, [this] {
    static_cast<void>(connected());
    stop_after_controller_ = true;
  });
  RunOptions options;
  options.stop_wait_s = 0.2;
  EXPECT_STREQ(run(options).ended, "interrupted");
  EXPECT_LT(robot_.time_s(), kSoon_s);
}

}  // namespace
}  // namespace stilt::robot_on_bus
