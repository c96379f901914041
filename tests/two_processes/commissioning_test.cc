#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "firmware/configuration/configuration.h"
#include "firmware/telemetry/token.h"
#include "tests/two_processes/frame_record.h"
#include "tests/two_processes/host.h"
#include "tests/two_processes/person.h"
#include "tests/two_processes/robot_and_controller.h"

/// The commands before the controller, as a person types them.
namespace stilt::two_processes {
namespace {

const std::vector<std::string> kHanging = {"--lockstep", "--once", "--hang"};

std::vector<std::string> with(std::vector<std::string> options, const std::vector<std::string>& more) {
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

std::string answers(const RobotAndController& run, const std::string& text) {
  const std::string file = run.file("answers");
  std::ofstream(file) << text;
  return file;
}

hal::RobotWiring shipped_wiring() {
  return configuration::robot_wiring(configuration::load_robot("amber3m").value().hardware);
}

std::string last_line(const std::string& file) {
  std::ifstream lines(file);
  std::string last;
  for (std::string line; std::getline(lines, line);) last = line;
  return last;
}

TEST(TwoProcesses, AScanFindsTheDriversOfTheRobot) {
  RobotAndController run;
  run.start_robot(kHanging);
  run.start_command({"scan"}, {"--lockstep"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
  EXPECT_EQ(run.controller_json().at("complete"), true);
  EXPECT_NE(text_of(run.file("controller.out")).find("knee_R (mit_damiao 4): answers"), std::string::npos);
}

TEST(TwoProcesses, AScanWithAMissingDriverFails) {
  RobotAndController run;
  run.start_robot(with(kHanging, {"--set", "knee_R.id=9"}));
  run.start_command({"scan"}, {"--lockstep"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << run.said();
}

TEST(TwoProcesses, AWatchWritesALineASample) {
  RobotAndController run;
  run.start_robot(kHanging);
  run.start_command({"watch"}, {"--lockstep", "--duration", "1"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
  std::ifstream lines(run.file("controller.json"));
  int samples = 0;
  for (std::string line; std::getline(lines, line); ++samples) {
    EXPECT_TRUE(nlohmann::json::parse(line).at("joints").contains("hip_R"));
  }
  EXPECT_EQ(samples, 10);
}

TEST(TwoProcesses, WhatFramesCannotCarryIsRefusedBeforeAJointGetsTorque) {
  RobotAndController run;
  const std::vector<std::string> narrow = {"--set", "knee_driver.position_range_rad=1.2"};
  const std::vector<std::vector<std::string>> commands = {{"identify"}, {"jog", "knee_L", "0.2"}};
  for (const std::vector<std::string>& command : commands) {
    run.start_command(command, with(narrow, {"--lockstep"}));
    EXPECT_EQ(run.controller().wait(kLongestRun_s), 2) << run.said();
    EXPECT_NE(text_of(run.file("controller.err")).find("buses, drivers or joints cannot do this"),
              std::string::npos);
  }
}

/// A bus withholds a frame whose predecessor has not left: a single one that switches off may never leave.
TEST(TwoProcesses, TheLastFrameOfACommandSwitchesTheDriverOff) {
  RobotAndController run;
  run.start_robot(kHanging);
  run.start_command({"watch"}, {"--lockstep", "--duration", "1"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
  const MotorTraffic traffic = motor_traffic(read_frames(run.file("frames")), shipped_wiring());
  ASSERT_FALSE(traffic.commands.empty());
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    std::uint64_t commanded = 0, switched_off = 0;
    for (const MotorTraffic::Command& command : traffic.commands) {
      if (command.joint == joint) commanded = command.tick;
    }
    for (const MotorTraffic::Special& special : traffic.specials) {
      if (special.joint == joint && special.what == hal::mit::MitSpecial::leave) switched_off = special.tick;
    }
    EXPECT_GT(switched_off, commanded) << joint;
  }
}

TEST(TwoProcesses, AWatchWhoseLinesAreLostEndsAndSaysSo) {
  RobotAndController run;
  run.start_robot(kHanging);
  Process watch({STILTD_PROGRAM, "watch", "--lockstep", "--bus", run.bus(0), "--bus", run.bus(1), "--set",
                 "telemetry.enabled=false", "--json", "/dev/full"},
                run.file("controller.out"), run.file("controller.err"));
  EXPECT_EQ(watch.wait(kLongestRun_s), 2) << run.said();
  EXPECT_TRUE(run.robot().wait(kLongestRun_s)) << run.said();
  EXPECT_NE(text_of(run.file("controller.err"))
                .find("stiltd: --json /dev/full: cannot be written (No space left on device); name a file"),
            std::string::npos)
      << run.said();
}

TEST(TwoProcesses, ABusDoesNotTakeThePlaceOfAClosedStandardStream) {
  RobotAndController run;
  run.start_robot(kHanging);
  const std::string lines = run.file("controller.json");
  Process watch(
      {"/bin/sh", "-c", "exec \"$@\" <&- >&- 2>&-", "sh", STILTD_PROGRAM, "watch", "--lockstep", "--bus",
       run.bus(0), "--bus", run.bus(1), "--set", "telemetry.enabled=false", "--json", lines},
      run.file("controller.out"), run.file("controller.err"));
  ASSERT_TRUE(wait_for_text(lines, "emergency_stop", kLongestRun_s)) << run.said();
  for (const char* stream : {"0", "1", "2"}) {
    const std::string link = "/proc/" + std::to_string(watch.id()) + "/fd/" + stream;
    EXPECT_EQ(std::filesystem::read_symlink(link), "/dev/null") << stream;
  }
  watch.signal(SIGINT);
  EXPECT_EQ(watch.wait(kLongestRun_s), 2) << "its table is lost\n" << run.said();
}

TEST(TwoProcesses, AWatchIsOnTheNetworkAndOnlyOffEndsIt) {
  RobotAndController run;
  run.start_robot(kHanging);
  Host host;
  run.start_command({"watch"}, {"--lockstep"});
  ASSERT_TRUE(host.until([&] { return host.run_id != 0 && host.state_name == "watch"; })) << run.said();
  host.learn(telemetry::read_token(run.file("token")).value());
  host.alive = true;
  const std::string stand = host.ask(telemetry::CommandKind::stand);
  EXPECT_EQ(stand, "the robot is in state watch; it can stand up from idle or ready");
  EXPECT_NE(host.ask(telemetry::CommandKind::walk, 0.3), "accepted");
  EXPECT_EQ(host.ask(telemetry::CommandKind::off), "accepted");
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
  const nlohmann::json last = nlohmann::json::parse(last_line(run.file("controller.json")));
  const char* const names[] = {"hip_L", "knee_L", "hip_R", "knee_R"};
  for (std::size_t joint = 0; joint < 4; ++joint) {
    EXPECT_NEAR(last.at("joints").at(names[joint]).at("position_rad"), host.joint_position_rad[joint], 0.05);
  }
}

TEST(TwoProcesses, AJogNamesAReversedMotorFromAnswersInAFile) {
  RobotAndController run;
  run.start_robot(with(kHanging, {"--miswired", "motor-reversed:hip_L"}));
  run.start_command({"jog", "hip_L", "-0.2"},
                    {"--lockstep", "--answers", answers(run, "left thigh\nbackward\n")});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << run.said();
  EXPECT_EQ(run.controller_json().at("finding"), "reversed_motor");
  EXPECT_LT(run.controller_json().at("peak_torque_Nm"), 16.0);
}

/// The command is to name the driver that is missing, also in its JSON.
class FailedCommand : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(FailedCommand, WritesTheReasonAsJson) {
  RobotAndController run;
  run.start_robot(with(kHanging, {"--set", "knee_R.id=9"}));
  run.start_command(GetParam(), {"--lockstep"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << run.said();
  EXPECT_EQ(run.controller_json().at("good"), false);
  const std::string error = run.controller_json().at("error");
  EXPECT_NE(error.find("knee_R"), std::string::npos) << error;
  EXPECT_NE(text_of(run.file("controller.err")).find(error), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(TwoProcesses, FailedCommand,
                         testing::Values(std::vector<std::string>{"watch"},
                                         std::vector<std::string>{"jog", "hip_L", "0.2"},
                                         std::vector<std::string>{"calibrate"},
                                         std::vector<std::string>{"identify"}),
                         [](const auto& row) { return row.param.front(); });

TEST(TwoProcesses, AJogWithAnswersThatAreNoneIsBadInput) {
  RobotAndController run;
  run.start_robot(kHanging);
  run.start_command({"jog", "hip_L", "0.2"}, {"--lockstep", "--answers", answers(run, "banana\n")});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 2) << run.said();
  EXPECT_NE(text_of(run.file("controller.err")).find("\"banana\" is no answer to: Which link"),
            std::string::npos);
}

/// A person who presses Enter and moves nothing.
TEST(TwoProcesses, ACalibrateOfJointsThatDidNotMoveWritesNothingAndGivesNoTorque) {
  RobotAndController run;
  run.start_robot(with(kHanging, {"--plant", "joint_friction_Nm=20", "--plant", "joint_damping=5"}));
  const std::string out = run.file("out.toml");
  run.start_command({"calibrate"},
                    {"--lockstep", "--out", out, "--answers", answers(run, std::string(20, '\n'))});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << run.said();
  const nlohmann::json found = run.controller_json();
  EXPECT_EQ(found.at("good"), false);
  for (const auto& [joint, result] : found.at("joints").items()) {
    EXPECT_EQ(result.at("finding"), "dead_encoder") << joint;
  }
  EXPECT_FALSE(std::filesystem::exists(out));
  const nlohmann::json robot = run.robot_json();
  for (const double torque_Nm : robot.at("peak_torque_Nm")) EXPECT_EQ(torque_Nm, 0.0);
}

TEST(TwoProcesses, ACalibrateByHandFindsOffsetsAndWithThemTheRobotStands) {
  RobotAndController run;
  const Pipe hands(run.file("hands")), keyboard(run.file("keyboard"));
  const std::vector<std::string> wiring = {"--set", "hip_L.offset_rad=0.25", "--set",
                                           "knee_R.reversed=false"};
  run.start_robot(with(with(kHanging, {"--hands", hands.name()}), wiring));
  const std::string out = run.file("out.toml");
  run.start_command({"calibrate"}, {"--lockstep", "--set", "knee_R.reversed=false", "--out", out},
                    keyboard.name());
  HelpingPerson(run, hands, keyboard).calibrates();
  run.expect_both_to_end();
  ASSERT_EQ(run.controller().wait(0), 0) << run.said();
  const nlohmann::json found = run.controller_json();
  EXPECT_EQ(found.at("good"), true) << found;
  EXPECT_EQ(found.at("written"), out);
  EXPECT_EQ(found.at("joints").at("knee_R").at("reversed"), false) << found;
  EXPECT_NEAR(found.at("joints").at("hip_L").at("offset_rad"), 0.25, 0.01) << found;
  const nlohmann::json robot = run.robot_json();
  for (const double torque_Nm : robot.at("peak_torque_Nm")) EXPECT_EQ(torque_Nm, 0.0);

  run.start_robot(with({"--lockstep", "--once"}, wiring));
  run.start_controller({"--lockstep", "--config", out, "--start", "stand", "--duration", "6"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
  EXPECT_EQ(run.robot_json().at("survived"), true) << run.said();
}

TEST(TwoProcesses, WhatWasFoundIsReportedAlsoWhenItCannotBeWritten) {
  RobotAndController run;
  run.start_robot(kHanging);
  run.start_command({"identify"}, {"--lockstep", "--out", "/dev/full"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 2) << run.said();
  EXPECT_NE(text_of(run.file("controller.err")).find("--out /dev/full: cannot be written (No space left"),
            std::string::npos)
      << run.said();
  EXPECT_NE(text_of(run.file("controller.out")).find("robot.hip_coulomb_friction_Nm = "), std::string::npos);
  EXPECT_TRUE(run.controller_json().at("written").is_null());
  const std::string error = run.controller_json().at("error");
  EXPECT_TRUE(error.starts_with("--out /dev/full: cannot be written (No space left")) << error;
}

TEST(TwoProcesses, AnOutFileThatIsNoConfigurationIsRefusedBeforeAnythingMoves) {
  RobotAndController run;
  run.start_robot(kHanging);
  const std::string out = run.file("out.toml");
  std::ofstream(out) << "[hip_L\n";
  run.start_command({"identify"}, {"--lockstep", "--out", out});
  EXPECT_EQ(run.controller().wait(kLongestRun_s), 2) << run.said();
  EXPECT_NE(text_of(run.file("controller.err")).find(out + ":1:"), std::string::npos) << run.said();
}

TEST(TwoProcesses, NoCommandWorksBesideARunningController) {
  RobotAndController run;
  run.start_robot({"--once", "--hang"});
  run.start_command({"watch"}, {"--duration", "60"});
  ASSERT_TRUE(wait_for_text(run.file("controller.json"), "hip_R", kLongestRun_s)) << run.said();
  for (const std::string command : {"scan", "watch", "jog hip_L 0.2"}) {
    const std::string line = std::string(STILTD_PROGRAM) + " " + command + " --bus " + run.bus(0) +
                             " --bus " + run.bus(1) + " > " + run.file("second") + " 2>&1";
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 2);
    EXPECT_NE(text_of(run.file("second")).find("commands the drivers; end it first"), std::string::npos)
        << text_of(run.file("second"));
  }
  run.controller().signal(SIGINT);
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
}

TEST(TwoProcesses, AJogOnAThreadThatDidNotGetItsProcessorIsNotRealTime) {
  RobotAndController run;
  run.start_robot({"--once", "--hang"});
  run.start_command({"jog", "hip_L", "0.2"},
                    {"--set", "runtime.torque_core=1023", "--answers", answers(run, "none\n")});
  EXPECT_TRUE(wait_for_text(run.file("controller.err"),
                            "not real time: the thread of the commissioning did not get ", kLongestRun_s))
      << run.said();
  run.controller().signal(SIGINT);
  run.expect_both_to_end();
}

TEST(TwoProcesses, NoSelfTestWorksBesideAControllerThatWalks) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once"});
  run.start_controller({"--lockstep", "--start", "walk@0.4"});
  ASSERT_TRUE(wait_for_text(run.file("controller.err"), " walk\n", kLongestRun_s)) << run.said();
  const std::string line = std::string(STILTD_PROGRAM) + " selftest --seconds 1 --bus " + run.bus(0) +
                           " --bus " + run.bus(1) + " > " + run.file("second") + " 2>&1";
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 2);
  EXPECT_NE(text_of(run.file("second")).find("commands the drivers; end it first"), std::string::npos)
      << text_of(run.file("second"));
  run.end_robot();
  run.expect_both_to_end();
  EXPECT_EQ(run.robot_json().at("survived"), true) << run.said();
  EXPECT_EQ(run.controller_json().at("faults").at(0).at("name"), "bus_disconnected")
      << "nothing before the robot ended: " << run.controller_json().at("faults");
}

struct LimitedRun {
  const char* name;
  const char* fault;  ///< of the robot; empty: none
  int status;         ///< of the controller at its end
};

/// Stands up, stands and sits, or is held or damped after a fault: what the plant's motors gave.
class TorqueLimit : public testing::TestWithParam<LimitedRun> {};

TEST_P(TorqueLimit, HoldsFromStandingUpToTheEnd) {
  RobotAndController run;
  std::vector<std::string> robot = {"--lockstep", "--once"};
  if (*GetParam().fault != '\0') robot = with(robot, {"--fault", GetParam().fault});
  run.start_robot(robot);
  run.start_controller({"--lockstep", "--torque-limit", "0.3", "--start", "stand", "--duration", "8"});
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), GetParam().status) << run.said();
  const nlohmann::json plant = run.robot_json();
  EXPECT_FALSE(plant.at("gantry_released_s").is_null()) << "it stood on its own: " << run.said();
  // A driver that closes gains itself measures how the joint moves between two commands: kp 100 Nm/rad, 3
  // rad/s, 2 ms.
  constexpr double kBetweenCommands_Nm = 0.6;
  for (const double torque_Nm : plant.at("peak_torque_Nm")) {
    EXPECT_LE(torque_Nm, 0.3 * 80.0 + kBetweenCommands_Nm);
  }
}

INSTANTIATE_TEST_SUITE_P(TwoProcesses, TorqueLimit,
                         testing::Values(LimitedRun{"NoFault", "", 0},
                                         LimitedRun{"EmergencyStop", "emergency-stop@1", 1},
                                         LimitedRun{"LostReplies", "drop:hip_L@1+0.005", 0},
                                         LimitedRun{"Overheated", "over-temperature@1", 1}),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace stilt::two_processes
