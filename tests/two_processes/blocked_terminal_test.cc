// A terminal that takes no more output holds housekeeping up: the robot has no commander then, and signals
// still stop it. By the clock, with limits that a busy machine does not reach.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "tests/two_processes/frame_record.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

constexpr auto kPause = std::chrono::milliseconds(20);

/// A pipe with a name in the place of a terminal, as small as the kernel makes one.
class Terminal {
 public:
  explicit Terminal(const std::string& name) {
    EXPECT_EQ(mkfifo(name.c_str(), 0600), 0) << name;
    pipe_ = open(name.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    EXPECT_GE(fcntl(pipe_, F_SETPIPE_SZ, 4096), 0);
  }
  ~Terminal() { close(pipe_); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Takes what was written so far.
  void read() {
    std::array<char, 512> part;
    for (ssize_t got = 0; (got = ::read(pipe_, part.data(), part.size())) > 0;)
      text_.append(part.data(), static_cast<std::size_t>(got));
  }
  /// False: the program ended without it.
  [[nodiscard]] bool wait_for(const std::string& words, Process& program) {
    for (read(); text_.find(words) == std::string::npos; read()) {
      if (program.wait(0)) return false;
      std::this_thread::sleep_for(kPause);
    }
    return true;
  }
  /// Leaves no room for a byte.
  void fill() {
    const std::array<char, 512> filling{};
    while (write(pipe_, filling.data(), filling.size()) > 0) {
    }
    while (write(pipe_, filling.data(), 1) > 0) {
    }
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  int pipe_ = -1;
  std::string text_;
};

const std::vector<std::string> kOnABusyMachine = {"--start", "stand",
                                                  "--set",   "supervisor.torque_loop_stall_s=10",
                                                  "--set",   "supervisor.missed_hold_ticks=500",
                                                  "--set",   "supervisor.missed_damp_ticks=1000",
                                                  "--set",   "supervisor.stale_plan_s=5",
                                                  "--set",   "hardware.driver_watchdog_s=0.1"};

TEST(TwoProcesses, AStoppedTerminalKeepsNoSignalFromCuttingTheMotors) {
  RobotAndController run;
  Terminal terminal(run.file("controller.err"));
  run.start_robot({});
  run.start_controller(kOnABusyMachine);
  ASSERT_TRUE(terminal.wait_for(" s  stand", run.controller())) << terminal.text();
  std::this_thread::sleep_for(std::chrono::seconds(1));
  terminal.fill();
  run.controller().signal(SIGUSR1);  // its histograms find no room
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  run.controller().signal(SIGQUIT);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  run.end_robot();
  ASSERT_TRUE(run.robot().wait(kLongestRun_s));
  const configuration::Result shipped = configuration::load_robot("amber3m");
  ASSERT_TRUE(shipped);
  const MotorTraffic traffic =
      motor_traffic(read_frames(run.file("frames")), configuration::robot_wiring(shipped->hardware));
  ASSERT_FALSE(traffic.commands.empty());
  ASSERT_FALSE(traffic.specials.empty());
  EXPECT_EQ(traffic.specials.back().what, hal::mit::MitSpecial::leave);
  EXPECT_GE(traffic.specials.back().tick, traffic.commands.back().tick) << "no torque follows";
  EXPECT_TRUE(std::ranges::none_of(run.robot_json().at("drivers"), [](const nlohmann::json& driver) {
    return driver.at("enabled").get<bool>();
  })) << run.robot_json().at("drivers");
  EXPECT_FALSE(run.controller().wait(0)) << "its last output finds no room";
  while (!run.controller().wait(0)) {
    terminal.read();
    std::this_thread::sleep_for(kPause);
  }
  EXPECT_EQ(run.controller_json().at("last_state"), "stand") << terminal.text();
}

TEST(TwoProcesses, AStoppedTerminalMakesAStandingRobotSitDown) {
  RobotAndController run;
  Terminal terminal(run.file("controller.err"));
  run.start_robot({"--once"});
  std::vector<std::string> options = kOnABusyMachine;
  options.insert(options.end(), {"--set", "supervisor.operator_gone_s=2"});
  run.start_controller(options);
  ASSERT_TRUE(terminal.wait_for(" s  stand", run.controller())) << terminal.text();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  terminal.fill();
  run.controller().signal(SIGUSR1);  // its histograms find no room
  std::this_thread::sleep_for(std::chrono::seconds(9));
  ASSERT_FALSE(run.controller().wait(0)) << "it runs";
  run.controller().signal(SIGINT);
  while (!run.controller().wait(0)) {
    terminal.read();
    std::this_thread::sleep_for(kPause);
  }
  ASSERT_TRUE(run.robot().wait(kLongestRun_s)) << terminal.text();
  const nlohmann::json faults = run.controller_json().at("faults");
  const auto reaction = [&faults](const char* name) {
    const auto fault =
        std::ranges::find(faults, name, [](const nlohmann::json& one) { return one.at("name"); });
    return fault == faults.end() ? std::string() : fault->at("reaction").get<std::string>();
  };
  EXPECT_EQ(reaction("heartbeat_lost"), "slow") << faults;
  EXPECT_EQ(reaction("operator_gone"), "sit") << faults;
  EXPECT_TRUE(run.robot_json().at("survived")) << terminal.text();
  EXPECT_FALSE(run.robot_json().at("sat_down_s").is_null()) << terminal.text();
}

}  // namespace
}  // namespace stilt::two_processes
