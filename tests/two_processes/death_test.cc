// One of the two dies without a word: motors must not go on without their controller, nor it without them.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <optional>
#include <string_view>
#include <thread>

#include "firmware/configuration/configuration.h"
#include "tests/two_processes/frame_record.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

bool any_enabled(const nlohmann::json& robot) {
  return std::ranges::any_of(robot.at("drivers"),
                             [](const nlohmann::json& driver) { return driver.at("enabled").get<bool>(); });
}

TEST(TwoProcesses, AfterAKillTheDriversDisableThemselvesAndARestartComesUpIdle) {
  RobotAndController run;
  run.start_robot({"--lockstep"});
  run.start_controller({"--lockstep", "--start", "walk@0.5"});
  ASSERT_TRUE(wait_for_text(run.file("controller.err"), "walk", kLongestRun_s)) << run.said();
  run.controller().signal(SIGKILL);
  ASSERT_EQ(run.controller().wait(kLongestRun_s), 128 + SIGKILL);

  run.start_controller({"--lockstep", "--duration", "2"});
  ASSERT_EQ(run.controller().wait(kLongestRun_s), 0) << run.said();
  const nlohmann::json controller = run.controller_json();
  EXPECT_EQ(controller.at("last_state"), "idle");
  EXPECT_TRUE(controller.at("faults").empty()) << controller.at("faults");
  run.robot().signal(SIGTERM);
  ASSERT_EQ(run.robot().wait(kLongestRun_s), 1) << "it fell\n" << run.said();
  const nlohmann::json robot = run.robot_json();
  EXPECT_EQ(robot.at("controllers"), 2);
  const auto came_s = robot.at("controllers_came_s").get<std::vector<double>>();
  ASSERT_EQ(came_s.size(), 2u);
  EXPECT_EQ(came_s[0], 0.0);
  EXPECT_GT(came_s[1], 1.0);
  const std::string robot_says = text_of(run.file("robot.out"));
  EXPECT_NE(robot_says.find("the controller's, which came 0.00 s after the start"), std::string::npos)
      << "that of the controller that stood it up\n"
      << robot_says;
  EXPECT_FALSE(robot.at("survived"));
  EXPECT_FALSE(any_enabled(robot));

  const configuration::Result shipped = configuration::load_robot("amber3m");
  ASSERT_TRUE(shipped);
  const MotorTraffic traffic =
      motor_traffic(read_frames(run.file("frames")), configuration::robot_wiring(shipped->hardware));
  ASSERT_FALSE(traffic.commands.empty());
  const std::uint64_t last = traffic.commands.back().tick;
  EXPECT_TRUE(std::ranges::none_of(traffic.specials, [last](const MotorTraffic::Special& special) {
    return special.tick > last && special.what == hal::mit::MitSpecial::enter;
  })) << "an idle controller enables nothing";
}

/// The gantry lifts the robot that fell when its controller died. Standing up in the air ends damped, not in
/// a fault, and the robot stays whole. Once it hangs still, it stands up as ever.
TEST(TwoProcesses, ARestartWhileTheRobotIsBeingLiftedEndsInNoFault) {
  RobotAndController run;
  run.start_robot({"--lockstep"});
  run.start_controller({"--lockstep", "--start", "walk@0.5"});
  ASSERT_TRUE(wait_for_text(run.file("controller.err"), "walk", kLongestRun_s)) << run.said();
  run.controller().signal(SIGKILL);
  ASSERT_EQ(run.controller().wait(kLongestRun_s), 128 + SIGKILL);
  for (const char* attempt : {"at once", "later", "hanging"}) {
    run.start_controller({"--lockstep", "--start", "stand", "--duration", "6"});
    const std::optional<int> status = run.controller().wait(kLongestRun_s);
    const nlohmann::json results = run.controller_json();
    EXPECT_TRUE(results.at("faults").empty()) << attempt << results.at("faults");
    EXPECT_EQ(status, results.contains("error") ? 1 : 0) << attempt << "\n" << run.said();
    if (attempt == std::string_view("hanging")) {
      EXPECT_EQ(status, 0) << run.said();
    }
  }
}

TEST(TwoProcesses, AControllerWhoseTerminalEndsSitsDownFirst) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once"});
  run.start_controller({"--lockstep", "--start", "walk@0.5"});
  ASSERT_TRUE(wait_for_text(run.file("controller.err"), "walk", kLongestRun_s)) << run.said();
  run.controller().signal(SIGPIPE);
  run.controller().signal(SIGHUP);
  run.expect_both_to_end();
  const nlohmann::json controller = run.controller_json();
  EXPECT_EQ(controller.at("last_state"), "ready") << "it sat down" << run.said();
  EXPECT_TRUE(controller.at("faults").empty()) << controller.at("faults");
}

/// As a terminal sends it to all programs that it started, and as ros2 launch does.
TEST(TwoProcesses, OneCtrlCForBothSitsTheRobotDown) {
  RobotAndController run;
  run.start_robot({"--lockstep"});
  run.start_controller({"--lockstep", "--start", "walk@0.5"});
  ASSERT_TRUE(wait_for_text(run.file("controller.err"), " walk\n", kLongestRun_s)) << run.said();
  run.robot().signal(SIGINT);
  run.controller().signal(SIGINT);
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
  EXPECT_EQ(run.robot().wait(0), 0) << run.said();
  EXPECT_TRUE(run.controller_json().at("faults").empty()) << run.controller_json().at("faults");
  const nlohmann::json robot = run.robot_json();
  EXPECT_EQ(robot.at("ended"), "interrupted");
  EXPECT_FALSE(robot.at("sat_down_s").is_null()) << run.said();
  EXPECT_FALSE(any_enabled(robot));
}

TEST(TwoProcesses, ASecondCtrlCEndsTheRobotBesideItsController) {
  RobotAndController run;
  run.start_robot({});
  run.start_controller({});
  ASSERT_TRUE(wait_for_text(run.file("controller.err"), " s  idle", kLongestRun_s)) << run.said();
  run.end_robot();
  ASSERT_TRUE(run.robot().wait(kLongestRun_s)) << run.said();
  EXPECT_EQ(run.robot_json().at("ended"), "interrupted");
  EXPECT_LT(run.robot_json().at("ended_s"), 20.0) << "after the first it would have gone on for 30 s";
}

/// A program that the kernel stops would leave its motors with torque.
TEST(TwoProcesses, TheKeysBesideCtrlCDoNotStopTheTorqueLoop) {
  for (const auto& [key, last_state] : {std::pair(SIGTSTP, "ready"), {SIGQUIT, "stand"}}) {
    RobotAndController run;
    run.start_robot({"--lockstep", "--once"});
    run.start_controller({"--lockstep", "--start", "stand"});
    ASSERT_TRUE(wait_for_text(run.file("controller.err"), "stand", kLongestRun_s)) << run.said();
    run.controller().signal(SIGTTIN);
    run.controller().signal(SIGTTOU);
    run.controller().signal(key);
    ASSERT_EQ(run.controller().wait(kLongestRun_s), 0) << run.said();
    EXPECT_EQ(run.controller_json().at("last_state"), last_state) << key << run.said();
    ASSERT_GE(run.robot().wait(kLongestRun_s), 0);
    EXPECT_FALSE(any_enabled(run.robot_json())) << key;
  }
}

TEST(TwoProcesses, ASecondInterruptTurnsTheMotorsOffAtOnce) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once"});
  run.start_controller({"--lockstep", "--start", "walk@0.5"});
  ASSERT_TRUE(wait_for_text(run.file("controller.err"), "walk", kLongestRun_s)) << run.said();
  run.robot().signal(SIGSTOP);  // the controller waits for it: hardly a tick lies between the two
  run.controller().signal(SIGINT);
  while (run.controller().has_pending(SIGINT)) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(400));  // the two must be 0.3 s apart
  run.controller().signal(SIGINT);
  run.robot().signal(SIGCONT);
  ASSERT_EQ(run.controller().wait(kLongestRun_s), 0) << run.said();
  const std::string last_state = run.controller_json().at("last_state");
  EXPECT_TRUE(last_state == "walk" || last_state == "step") << "it did not stand or sit first\n"
                                                            << run.said();
  ASSERT_GE(run.robot().wait(kLongestRun_s), 0);
  EXPECT_FALSE(any_enabled(run.robot_json()));
}

TEST(TwoProcesses, AControllerWhoseRobotDiesInMidWalkDampsAndEnds) {
  RobotAndController run;
  run.start_robot({"--lockstep"});
  run.start_controller({"--lockstep", "--start", "walk@0.5"});
  ASSERT_TRUE(wait_for_text(run.file("controller.err"), "walk", kLongestRun_s)) << run.said();
  run.robot().signal(SIGKILL);
  ASSERT_EQ(run.robot().wait(kLongestRun_s), 128 + SIGKILL);
  ASSERT_EQ(run.controller().wait(kLongestRun_s), 1) << run.said();
  const nlohmann::json controller = run.controller_json();
  EXPECT_EQ(controller.at("last_state"), "fault");
  // A command withheld in the same tick is a warning besides.
  const nlohmann::json& faults = controller.at("faults");
  const auto damps = std::ranges::find_if(
      faults, [](const nlohmann::json& fault) { return fault.at("reaction") != "warn"; });
  ASSERT_NE(damps, faults.end()) << faults;
  EXPECT_EQ(damps->at("name"), "bus_disconnected") << faults;
  EXPECT_EQ(damps->at("reaction"), "damp") << faults;
  EXPECT_EQ(damps->at("time_s"), faults.at(0).at("time_s")) << faults;
  EXPECT_NE(text_of(run.file("controller.err")).find("stopped answering"), std::string::npos) << run.said();
}

/// A stopped robot acknowledges nothing, as drivers without power.
TEST(TwoProcesses, AProgramNamesTheBusesWhoseLastCommandsNoDriverHasAcknowledged) {
  for (const bool commissioning : {false, true}) {
    RobotAndController run;
    run.start_robot({"--once"});
    if (commissioning) {
      run.start_command({"watch"}, {"--duration", "600"});
      ASSERT_TRUE(wait_for_text(run.file("controller.json"), "hip_R", kLongestRun_s)) << run.said();
    } else {
      run.start_controller({});
      ASSERT_TRUE(wait_for_text(run.file("controller.err"), " s  idle", kLongestRun_s)) << run.said();
    }
    run.robot().signal(SIGSTOP);
    run.controller().signal(SIGTERM);
    EXPECT_TRUE(run.controller().wait(kLongestRun_s)) << run.said();
    run.robot().signal(SIGCONT);
    ASSERT_TRUE(run.robot().wait(kLongestRun_s)) << run.said();
    const std::string said = text_of(run.file("controller.err"));
    for (const std::size_t bus : {0, 1}) {
      EXPECT_NE(said.find("stiltd: bus " + run.bus(bus) + ": no driver has acknowledged"), std::string::npos)
          << said;
    }
  }
}

TEST(TwoProcesses, ARobotInRealTimeOutlivesItsController) {
  RobotAndController run;
  run.start_robot({"--once"});
  run.start_controller({"--start", "stand"});
  ASSERT_TRUE(wait_for_text(run.file("controller.err"), " s  idle", kLongestRun_s)) << run.said();
  run.controller().signal(SIGKILL);
  ASSERT_TRUE(run.robot().wait(kLongestRun_s)) << "a second after the controller it ends";
  EXPECT_EQ(run.robot_json().at("ended"), "controller left");
  EXPECT_FALSE(any_enabled(run.robot_json()));
}

}  // namespace
}  // namespace stilt::two_processes
