// Walks on other fallback levels and with other controllers, and the self-test, with two processes in
// lock-step.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "tests/two_processes/protocols.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

using Words = std::vector<std::string>;

Words with(Words options, const Words& more) {
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

/// Steps after this time of the robot since its release.
std::size_t steps_after(const nlohmann::json& robot, double time_s) {
  return static_cast<std::size_t>(std::ranges::count_if(
      robot.at("steps"), [time_s](const nlohmann::json& step) { return step.at("time_s") > time_s; }));
}

/// Faults of the controller until the end of the run: the robot leaves first, and what follows is its
/// silence.
nlohmann::json faults_of(const RobotAndController& run) {
  nlohmann::json faults = nlohmann::json::array();
  const nlohmann::json report = run.controller_json();
  for (const nlohmann::json& fault : report.at("faults")) {
    if (fault.at("name") == "bus_disconnected") break;
    faults.push_back(fault);
  }
  return faults;
}

/// Runs until the robot has walked this long.
void walk(RobotAndController& run, std::vector<std::string> controller, const char* seconds) {
  run.start_robot({"--lockstep", "--once", "--duration", seconds});
  controller.insert(controller.end(), {"--lockstep", "--start", "walk@0.5"});
  run.start_controller(controller);
  run.expect_both_to_end();
}

/// The planner stops 3 s after the release of the robot. Of 16 moments within two steps 14 are survived
/// (`stilt sim --planner-until`).
class WithoutPlans : public testing::TestWithParam<const char*> {};

TEST_P(WithoutPlans, TheRobotGoesOnSteppingOnAGait) {
  RobotAndController run;
  walk(run, {"--planner-until", "9.1", "--set", std::string("controller.reference=") + GetParam()}, "12");
  const nlohmann::json robot = run.robot_json();
  EXPECT_TRUE(robot.at("survived")) << run.said();
  EXPECT_GT(robot.at("ended_s").get<double>(), 12.0);
  EXPECT_GT(steps_after(robot, 9.3), 8u) << "on the gait";
  const nlohmann::json faults = faults_of(run);
  ASSERT_EQ(faults.size(), 1u) << faults;
  EXPECT_EQ(faults[0].at("name"), "plan_missing");
}

INSTANTIATE_TEST_SUITE_P(TwoProcesses, WithoutPlans, testing::Values("heuristic", "hzd"),
                         [](const auto& row) { return std::string(row.param); });

TEST(TwoProcesses, WithoutPlansAndWithoutGaitsItSitsDown) {
  RobotAndController run;
  walk(run, {"--planner-until", "9", "--set", "supervisor.track_gait=false"}, "12");
  const nlohmann::json faults = faults_of(run);
  EXPECT_TRUE(std::ranges::any_of(faults, [](const nlohmann::json& fault) {
    return fault.at("name") == "stale_plan" && fault.at("reaction") == "sit";
  })) << faults;
}

/// It slows down from 8 s on, would sit at 11 s, and is pushed at 10.6 s of its clock: it catches itself
/// first.
class StopsOfAPushedRobot : public testing::TestWithParam<const char*> {};

TEST_P(StopsOfAPushedRobot, EndInTheSittingPoseAndNotInAStep) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once", "--push", GetParam()});
  run.start_controller({"--lockstep", "--start", "walk@0.5", "--duration", "8"});
  run.expect_both_to_end();
  const nlohmann::json robot = run.robot_json();
  EXPECT_TRUE(robot.at("survived")) << robot.at("fall_time_s") << " s\n" << run.said();
  for (const nlohmann::json& fault : faults_of(run)) EXPECT_EQ(fault.at("reaction"), "warn") << fault;
}

INSTANTIATE_TEST_SUITE_P(TwoProcesses, StopsOfAPushedRobot,
                         testing::Values("60@9.0+0.4", "-60@9.0+0.4", "40@8.6+0.4"),
                         [](const auto& row) { return "push_" + std::to_string(row.index); });

TEST(TwoProcesses, PlansAroundGaitsOfTheLibraryWalkToo) {
  RobotAndController run;
  walk(run, {"--set", "controller.reference=hzd"}, "12");
  ASSERT_EQ(run.robot().wait(0), 0) << run.said();
  const nlohmann::json robot = run.robot_json();
  EXPECT_TRUE(robot.at("survived"));
  EXPECT_NEAR(robot.at("mean_speed_m_s").get<double>(), 0.5, 0.05);
  EXPECT_GT(robot.at("steps").size(), 20u) << "steps of 0.3 s, as the gaits have";
  EXPECT_TRUE(faults_of(run).empty()) << faults_of(run);
}

/// A driver's fault 4 s after the release; the run ends after the black box is full, or before.
class BlackBoxInLockStep : public testing::TestWithParam<const char*> {};

TEST_P(BlackBoxInLockStep, HoldsTheTicksAroundTheFault) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once", "--fault", "driver-fault:knee_L@4"});
  const std::string file = run.file("black_box.csv");
  run.start_controller({"--lockstep", "--start", "walk@0.5", "--duration", GetParam(), "--black-box", file});
  run.expect_both_to_end();
  const std::string ticks = text_of(file);
  EXPECT_EQ(ticks.find("tick,time_s,state,"), 0u) << run.said();
  EXPECT_NE(ticks.find(",walk,plan,none,"), std::string::npos) << "before the fault";
  EXPECT_NE(ticks.find(",fault,"), std::string::npos) << "after it";
  EXPECT_NE(ticks.find("driver_fault"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(TwoProcesses, BlackBoxInLockStep, testing::Values("10", "5.9"), [](const auto& row) {
  return row.param == std::string("10") ? "whole" : "cut_short";
});

/// The mild fault freezes the box first; the hard one, two seconds later, is in the file.
TEST(TwoProcesses, TheBlackBoxKeepsTheFallAndNotTheFirstGlitch) {
  RobotAndController run;
  run.start_robot(
      {"--lockstep", "--once", "--fault", "drop:knee_L@1+0.005", "--fault", "driver-fault:knee_L@4"});
  const std::string file = run.file("black_box.csv");
  run.start_controller({"--lockstep", "--start", "walk@0.5", "--duration", "10", "--black-box", file});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller_json().at("faults").at(0).at("name"), "missed_replies") << run.said();
  const std::string ticks = text_of(file);
  EXPECT_NE(ticks.find("driver_fault"), std::string::npos) << run.said();
  EXPECT_EQ(ticks.find("missed_replies", ticks.find('\n')), std::string::npos)
      << "the name of a column apart";
}

class SelfTest : public testing::TestWithParam<const char*> {};

TEST_P(SelfTest, EveryCommandIsAnsweredInTime) {
  RobotAndController run;
  const Words settings = with_protocol(GetParam());
  run.start_robot(with(settings, {"--lockstep", "--once"}));
  run.start_self_test(with(settings, {"--lockstep", "--seconds", "2"}));
  run.expect_both_to_end();
  ASSERT_EQ(run.controller().wait(0), 0) << run.said();
  const nlohmann::json report = run.controller_json();
  EXPECT_EQ(report.at("passed"), true);
  EXPECT_EQ(report.at("commands"), 2000);
  for (const char* joint : {"hip_L", "knee_L", "hip_R", "knee_R"}) {
    EXPECT_EQ(report.at("reply_share").at(joint), 1.0) << joint;
    EXPECT_EQ(report.at("in_time_share").at(joint), 1.0) << joint;
    EXPECT_EQ(report.at("missed_replies").at(joint), 0) << joint;
  }
  EXPECT_EQ(report.at("base_missed_replies"), 0);
  EXPECT_EQ(report.at("bus_errors"), 0);
}

INSTANTIATE_TEST_SUITE_P(TwoProcesses, SelfTest, testing::ValuesIn(kProtocols),
                         [](const auto& row) { return std::string(row.param); });

TEST(TwoProcesses, ASelfTestWithASilentDriverFails) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once", "--set", "knee_R.id=9"});
  run.start_self_test({"--lockstep", "--seconds", "1"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1);
  EXPECT_EQ(run.controller_json().at("passed"), false);
  EXPECT_NE(run.controller_json().at("failure").get<std::string>().find("knee_R"), std::string::npos);
}

/// By the clock, which a busy machine may fail besides.
TEST(TwoProcesses, ASelfTestWhosePlannerFindsNoPlanFails) {
  RobotAndController run;
  run.start_robot({"--once", "--hang"});
  run.start_self_test({"--seconds", "1", "--set", "sqp.plan_defect_max=1e-6", "--set",
                       "timing.plan_rate_hz=50", "--set", "runtime.planner_priority=0", "--set",
                       "runtime.torque_priority=0"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << run.said();
  const nlohmann::json report = run.controller_json();
  EXPECT_EQ(report.at("lockstep"), false);
  EXPECT_GT(report.at("solves"), 0) << run.said();
  EXPECT_EQ(report.at("failed_solves"), report.at("solves")) << run.said();
  const auto planner = std::ranges::find(report.at("checks"), "planner",
                                         [](const nlohmann::json& check) { return check.at("name"); });
  ASSERT_NE(planner, report.at("checks").end()) << run.said();
  EXPECT_EQ(planner->at("passed"), false);
  EXPECT_EQ(planner->at("limit").get<std::string>().find("at least 1 solves"), std::string::npos) << *planner;
}

/// Until a self-test commands the drivers: more frames than any bring-up has.
void wait_for_commands(const RobotAndController& run) {
  constexpr std::uintmax_t kBytes = 500'000;
  constexpr std::chrono::milliseconds kStep{20};
  std::error_code none_yet;
  for (double waited_s = 0; waited_s < kLongestRun_s; waited_s += 0.02) {
    const std::uintmax_t bytes = std::filesystem::file_size(run.file("frames"), none_yet);
    if (!none_yet && bytes > kBytes) return;
    std::this_thread::sleep_for(kStep);
  }
  ADD_FAILURE() << "no frames\n" << run.said();
}

TEST(TwoProcesses, ASelfTestWhoseBusesGoNamesThem) {
  RobotAndController run;
  run.start_robot({"--once", "--hang"});
  run.start_self_test(
      {"--seconds", "10", "--set", "runtime.planner_priority=0", "--set", "runtime.torque_priority=0"});
  wait_for_commands(run);
  run.end_robot();
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << run.said();
  const nlohmann::json report = run.controller_json();
  ASSERT_FALSE(report.at("checks").empty()) << run.said();
  const nlohmann::json& first = report.at("checks").at(0);
  EXPECT_EQ(first.at("name"), "bus errors") << run.said();
  EXPECT_TRUE(first.at("measured").get<std::string>().starts_with("bus 0 of hardware.buses is gone"))
      << run.said();
}

/// As a broken connection of ssh does.
TEST(TwoProcesses, ASelfTestThatIsStoppedHasNotPassed) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once"});
  run.start_self_test({"--lockstep", "--seconds", "600"});
  wait_for_commands(run);
  run.controller().signal(SIGHUP);
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << run.said();
  const nlohmann::json report = run.controller_json();
  EXPECT_EQ(report.at("good"), false);
  EXPECT_TRUE(report.at("error").get<std::string>().starts_with("stopped after ")) << run.said();
  EXPECT_FALSE(report.at("checks").empty()) << run.said();
}

/// A robot that stands or hangs, and what its self-test has to find.
struct Tested {
  const char* name;
  Words robot;
  Words test;
  const char* failed;  ///< the one check that fails; empty: it passes
};

class SelfTestOf : public testing::TestWithParam<Tested> {};

TEST_P(SelfTestOf, FailsTheOneCheckThatIsToBlame) {
  RobotAndController run;
  run.start_robot(with({"--lockstep", "--once"}, GetParam().robot));
  run.start_self_test(with({"--lockstep", "--seconds", "6"}, GetParam().test));
  run.expect_both_to_end();
  const std::string wanted = GetParam().failed;
  EXPECT_EQ(run.controller().wait(0), wanted.empty() ? 0 : 1) << run.said();
  Words failed;
  const nlohmann::json report = run.controller_json();
  for (const nlohmann::json& check : report.at("checks")) {
    if (!check.at("passed")) failed.push_back(check.at("name"));
  }
  EXPECT_EQ(failed, wanted.empty() ? Words{} : Words{wanted}) << run.said();
}

const Words kNoStop = {"--set", "torso_sensor.emergency_stop_released=none"};
const Words kCool = {"--set", "supervisor.hot_C=10", "--set", "supervisor.overheated_C=20"};
const Words kOtherSupply = with(with_protocol("moteus"), {"--set", "supervisor.low_voltage_V=100", "--set",
                                                          "supervisor.high_voltage_V=200"});
const Words kOdrive = with_protocol("odrive");
/// Switched on where the left thigh was 0.4 rad away from where it was calibrated.
const Words kVoidOffset = with(kOdrive, {"--hang", "--set", "hip_L.offset_rad=0.4"});

/// stiltd expects 500 values per second.
const Words kSlowTorsoSensor = {"--set", "torso_sensor.rate_hz=100"};
const Words kImpatience = {"--set", "supervisor.missed_damp_ticks=5"};

INSTANTIATE_TEST_SUITE_P(
    TwoProcesses, SelfTestOf,
    testing::Values(Tested{"ARobotWithoutAStop", kNoStop, kNoStop, "emergency stop"},
                    Tested{"ARobotWhoseMissingStopIsAccepted", kNoStop,
                           with(kNoStop, {"--accept-missing-stop"}), ""},
                    Tested{"AHotDriver", {}, kCool, "heat and supply"},
                    Tested{"AWrongSupply", with_protocol("moteus"), kOtherSupply, "heat and supply"},
                    Tested{"LegsThatHang", with(kOdrive, {"--hang"}), with(kOdrive, {"--hanging"}), ""},
                    Tested{"AVoidOffset", kVoidOffset, with(kOdrive, {"--hanging"}), "plumb"},
                    Tested{"ASlowTorsoSensor", kSlowTorsoSensor, kImpatience, "torso sensor"},
                    Tested{"ASlowTorsoSensorThatMay", kSlowTorsoSensor, {}, ""}),
    [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace stilt::two_processes
