// The main job with two processes in lock-step: the robot and the controller share only frames.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "tests/two_processes/frame_record.h"
#include "tests/two_processes/protocols.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

/// 60 s of it walking, at 0.5 m/s.
const std::vector<std::string> kWalk = {"--lockstep", "--start", "walk@0.5", "--duration", "64"};

void walk(RobotAndController& run) {
  run.start_robot({"--lockstep", "--once"});
  run.start_controller(kWalk);
  run.expect_both_to_end();
  ASSERT_EQ(run.controller().wait(0), 0) << run.said();
  ASSERT_EQ(run.robot().wait(0), 0) << run.said();
}

nlohmann::json simulation(RobotAndController& folder) {
  Process sim({STILT_PROGRAM, "sim", "--gait", "walk", "--speed", "0.5", "--duration", "60", "--json",
               folder.file("sim.json")},
              folder.file("sim.out"), folder.file("sim.err"));
  EXPECT_EQ(sim.wait(kLongestRun_s), 0);
  return nlohmann::json::parse(text_of(folder.file("sim.json")));
}

TEST(TwoProcesses, AMinuteOfWalkingRunsLikeTheSimulationAndRepeatsBitForBit) {
  RobotAndController first, second;
  walk(first);
  walk(second);
  if (HasFatalFailure()) return;

  const nlohmann::json robot = first.robot_json();
  EXPECT_TRUE(robot.at("survived")) << first.said();
  EXPECT_FALSE(robot.at("sat_down_s").is_null()) << "the controller sat it down at the end";
  EXPECT_TRUE(first.controller_json().at("faults").empty()) << first.controller_json().at("faults");
  EXPECT_GT(robot.at("steps").size(), 180u);
  const double mean_m_s = simulation(first).at("mean_speed_m_s");
  EXPECT_NEAR(robot.at("mean_speed_m_s").get<double>(), mean_m_s, 0.03);

  EXPECT_EQ(robot, second.robot_json());
  const std::string frames = text_of(first.file("frames"));
  EXPECT_GT(frames.size(), 10'000'000u);
  EXPECT_TRUE(frames == text_of(second.file("frames"))) << "every frame on the buses, with its tick";
}

/// Six seconds with the drivers of these options of robot and controller.
void walk_with(RobotAndController& run, const std::vector<std::string>& drivers) {
  std::vector<std::string> robot = drivers, controller = drivers;
  robot.insert(robot.end(), {"--lockstep", "--once", "--duration", "6"});
  controller.insert(controller.end(), {"--lockstep", "--start", "walk@0.5"});
  run.start_robot(robot);
  run.start_controller(controller);
  run.expect_both_to_end();
  ASSERT_EQ(run.robot().wait(0), 0) << run.said();
  EXPECT_TRUE(run.robot_json().at("survived"));
  EXPECT_GT(run.robot_json().at("steps").size(), 8u);
  EXPECT_NEAR(run.robot_json().at("mean_speed_m_s").get<double>(), 0.5, 0.05);
}

class WalkWith : public testing::TestWithParam<const char*> {};

TEST_P(WalkWith, DriversOfThisProtocol) {
  RobotAndController run;
  walk_with(run, with_protocol(GetParam()));
}

/// As current manuals of AK drivers have it: a driver answers with its own identifier.
TEST(TwoProcesses, WalkWithAkDriversThatAnswerWithTheirOwnIdentifiers) {
  std::vector<std::string> drivers = with_protocol("mit_ak");
  for (const char* joint :
       {"hip_L.reply_id=1", "knee_L.reply_id=2", "hip_R.reply_id=3", "knee_R.reply_id=4"}) {
    drivers.insert(drivers.end(), {"--set", joint});
  }
  RobotAndController run;
  walk_with(run, drivers);
}

/// Motors that give 0.8 and 1.25 of what their drivers are asked. With the factors identified, the robot
/// walks as one whose motors are exact, up to the steps of the frames. Their drivers give 5 Nm s/rad, which
/// are 4 at the weaker joint.
TEST(TwoProcesses, MotorsOfAnotherTorqueConstantWalkAsExactOnesOnceIdentified) {
  RobotAndController exact, identified;
  std::vector<std::string> options = {"--set", "supervisor.hold_kd_Nms_rad=4", "--set",
                                      "supervisor.damping_kd_Nms_rad=4"};
  walk_with(exact, options);
  options.insert(options.end(), {"--set", "hip_L.torque_factor=0.8", "--set", "knee_R.torque_factor=1.25"});
  walk_with(identified, options);
  if (HasFailure()) return;
  const nlohmann::json one = exact.robot_json(), other = identified.robot_json();
  EXPECT_EQ(one.at("steps").size(), other.at("steps").size());
  EXPECT_NEAR(one.at("mean_speed_m_s").get<double>(), other.at("mean_speed_m_s").get<double>(), 0.005);
}

/// They send positions ten times as fine beside each status. Every frame to such a driver, from bring-up to
/// the end, is a command of 8 bytes, and none of the special frames of version 2.
TEST(TwoProcesses, WalkWithAkOfVersionThreeThatSendPositionFrames) {
  std::vector<std::string> drivers = with_protocol("ak_v3");
  for (const char* setting :
       {"hip_driver.ak_v3_position_frames=true", "knee_driver.ak_v3_position_frames=true"}) {
    drivers.insert(drivers.end(), {"--set", setting});
  }
  RobotAndController run;
  walk_with(run, drivers);
  std::istringstream frames(text_of(run.file("frames")));
  std::size_t commands = 0, positions = 0;
  for (std::string line; std::getline(frames, line);) {
    if (line.find(" robot 00002A0") != std::string::npos) ++positions;
    const std::size_t command = line.find(" controller ");
    if (command == std::string::npos) continue;
    ++commands;
    const std::string frame = line.substr(command + std::string(" controller ").size());
    ASSERT_TRUE(frame.starts_with("0000080") && frame.size() == 25) << line;
    ASSERT_FALSE(frame.substr(9).starts_with("FFFFFFFFFFFFFF")) << line;
  }
  EXPECT_GT(commands, 20'000u);
  EXPECT_GT(positions, 10'000u);
}

/// Bring-up, commands, replies and registers in CAN FD frames; the torso sensor stays classic.
class WalkWithCanFd : public testing::TestWithParam<const char*> {};

TEST_P(WalkWithCanFd, DriversOfThisProtocol) {
  std::vector<std::string> drivers = with_protocol(GetParam());
  drivers.insert(drivers.end(), {"--set", "hip_driver.can_fd=true", "--set", "knee_driver.can_fd=true"});
  RobotAndController run;
  walk_with(run, drivers);
  std::istringstream frames(text_of(run.file("frames")));
  std::size_t flexible = 0, sensor = 0;
  for (std::string line; std::getline(frames, line);) {
    const bool fd = line.find("##1") != std::string::npos;
    const bool of_sensor = line.find(" 700#") != std::string::npos;
    flexible += fd ? 1 : 0;
    sensor += of_sensor ? 1 : 0;
    ASSERT_TRUE(fd != of_sensor || line.find("#R") != std::string::npos) << line;
  }
  EXPECT_GT(flexible, 20'000u);
  EXPECT_GT(sensor, 3'000u);
}

INSTANTIATE_TEST_SUITE_P(TwoProcesses, WalkWithCanFd, testing::Values("mit_damiao", "odrive"),
                         [](const auto& row) { return std::string(row.param); });

INSTANTIATE_TEST_SUITE_P(TwoProcesses, WalkWith, testing::ValuesIn(kProtocols),
                         [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace stilt::two_processes
