// What `stilt robot` reports of its run: on the controller's clock, and as much as can be written.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

/// Numbers behind a name in a text, in their order.
std::vector<double> numbers_after(const std::string& text, const std::string& name) {
  std::vector<double> numbers;
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    numbers.push_back(std::strtod(text.c_str() + at + name.size(), nullptr));
  }
  return numbers;
}

/// The first controller idles and leaves; the second, whose clock starts seconds later, walks.
TEST(TwoProcesses, AllTimesOfARobotAreOnTheClockOfTheControllerThatStoodItUp) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once", "--duration", "3", "--fault", "encoder-freeze:knee_L@2+0.001",
                   "--log", run.file("run.jsonl"), "--report", run.file("run.html")});
  run.start_controller({"--lockstep", "--start", "step", "--duration", "60"});
  run.expect_both_to_end();
  RobotAndController later;
  later.start_robot({"--lockstep", "--duration", "3", "--fault", "encoder-freeze:knee_L@2+0.001", "--log",
                     later.file("run.jsonl"), "--report", later.file("run.html")});
  later.start_controller({"--lockstep", "--duration", "2"});
  ASSERT_EQ(later.controller().wait(kLongestRun_s), 0) << later.said();
  later.start_controller({"--lockstep", "--start", "step", "--duration", "60"});
  later.expect_both_to_end();

  const nlohmann::json first = run.robot_json(), second = later.robot_json();
  const double came_s = second.at("controllers_came_s").at(1);
  ASSERT_GT(came_s, 2.0);
  EXPECT_EQ(first.at("clock_start_robot_time_s"), 0.0);
  EXPECT_EQ(second.at("clock_start_robot_time_s"), came_s);
  const double released_s = second.at("gantry_released_s");
  EXPECT_NEAR(released_s, first.at("gantry_released_s").get<double>(), 0.1)
      << "as if no other had come before";
  EXPECT_NEAR(second.at("ended_s").get<double>(), released_s + 3.0, 1e-6);
  EXPECT_NEAR(second.at("robot_time_s").get<double>(), released_s + 3.0 + came_s, 1e-6);
  EXPECT_NEAR(second.at("faults").at(0).at("time_s").get<double>(), released_s + 2.0, 0.0015);
  EXPECT_NEAR(second.at("faults").at(0).at("robot_time_s").get<double>(), released_s + 2.0 + came_s, 0.0015);
  const nlohmann::json& steps = second.at("steps");
  ASSERT_FALSE(steps.empty());
  EXPECT_GT(steps.front().at("time_s").get<double>(), released_s);
  EXPECT_GT(steps.back().at("time_s").get<double>(), released_s + 2.0);

  const std::vector<double> log_s = numbers_after(text_of(later.file("run.jsonl")), "{\"time_s\":");
  ASSERT_FALSE(log_s.empty());
  EXPECT_NEAR(log_s.front(), released_s, 0.0015);
  EXPECT_NEAR(log_s.back(), released_s + 3.0, 0.01);
  const std::vector<double> page_s = numbers_after(text_of(later.file("run.html")), "{\"time_s\":");
  const double last_step_s = steps.back().at("time_s");
  EXPECT_NE(std::ranges::find(page_s, last_step_s), page_s.end()) << "the report's last step";
  const std::string said = text_of(later.file("robot.out"));
  ASSERT_EQ(numbers_after(said, "released at ").size(), 1u) << said;
  EXPECT_NEAR(numbers_after(said, "released at ").front(), released_s, 0.006);
}

TEST(TwoProcesses, ARobotWithoutSpaceForItsFiguresStillWritesLogAndReport) {
  const RobotAndController names;  // of buses and files
  Process robot({STILT_PROGRAM, "robot", "--bus", names.bus(0), "--bus", names.bus(1), "--json", "/dev/full",
                 "--log", names.file("run.jsonl"), "--report", names.file("run.html")},
                names.file("robot.out"), names.file("robot.err"));
  ASSERT_TRUE(wait_for_text(names.file("robot.err"), "ready", kLongestRun_s));
  robot.signal(SIGINT);
  EXPECT_EQ(robot.wait(kLongestRun_s), 2);
  const std::string said = text_of(names.file("robot.err"));
  EXPECT_NE(said.find("--json /dev/full: the file cannot be written (No space left"), std::string::npos)
      << said;
  EXPECT_NE(said.find("written: " + names.file("run.jsonl")), std::string::npos) << said;
  EXPECT_NE(text_of(names.file("run.html")).find("<html"), std::string::npos);
}

/// Progress is reported after 1 s, and every 5 s when it has changed.
TEST(TwoProcesses, ARobotThatHangsSaysSoOnceAndNothingOfWalking) {
  const RobotAndController names;  // of buses and files
  Process robot({STILT_PROGRAM, "robot", "--bus", names.bus(0), "--bus", names.bus(1)},
                names.file("robot.out"), names.file("robot.err"));
  const std::string hanging = "the robot hangs on its gantry; on its own: 0 s\n";
  ASSERT_TRUE(wait_for_text(names.file("robot.err"), hanging, kLongestRun_s));
  std::this_thread::sleep_for(std::chrono::seconds(6));
  robot.signal(SIGINT);
  ASSERT_TRUE(robot.wait(kLongestRun_s));
  const std::string said = text_of(names.file("robot.err"));
  EXPECT_EQ(said.find(hanging), said.rfind(hanging)) << said;
  EXPECT_EQ(said.find("walk"), std::string::npos) << said;
  EXPECT_EQ(said.find("the robot is on its own"), std::string::npos) << said;
}

TEST(TwoProcesses, ABlackBoxThatCannotBeWrittenIsSaidAndIsStatusTwo) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once", "--fault", "driver-fault:knee_L@1"});
  run.start_controller({"--lockstep", "--start", "stand", "--duration", "20", "--black-box", "/dev/full"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 2) << run.said();
  EXPECT_NE(text_of(run.file("controller.err"))
                .find("stiltd: --black-box /dev/full: the black box cannot be written there (No space left"),
            std::string::npos)
      << run.said();
  EXPECT_EQ(run.controller_json().at("last_state"), "fault") << "the figures are there";
}

TEST(TwoProcesses, AStartThatWasNotReachedIsStatusOneAndSaysSo) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once"});
  run.start_controller({"--lockstep", "--start", "walk@0.5", "--duration", "2"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << run.said();
  const std::string error = run.controller_json().at("error");
  EXPECT_TRUE(error.starts_with("--start: the robot did not get there within --duration 2 s; ")) << error;
  EXPECT_NE(text_of(run.file("controller.err")).find("stiltd: " + error), std::string::npos) << run.said();
}

}  // namespace
}  // namespace stilt::two_processes
