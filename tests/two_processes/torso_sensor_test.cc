// Robot and controller with torso sensors that are no channels of the shipped table.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fstream>

#include "tests/pseudo_terminal.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

using Words = std::vector<std::string>;

/// Keys of other sections are named with these.
Words with_settings(Words options, const Words& settings) {
  for (const std::string& setting : settings) {
    const bool named = setting.find('.') < setting.find('=');
    options.insert(options.end(), {"--set", (named ? "" : "torso_sensor.") + setting});
  }
  return options;
}

struct Sensor {
  const char* name;
  Words settings;
};

class WalkWithTorsoSensor : public testing::TestWithParam<Sensor> {};

TEST_P(WalkWithTorsoSensor, SixSecondsWithoutAFault) {
  RobotAndController run;
  run.start_robot(with_settings({"--lockstep", "--once", "--duration", "6"}, GetParam().settings));
  run.start_controller(with_settings({"--lockstep", "--start", "walk@0.5"}, GetParam().settings));
  run.expect_both_to_end();
  ASSERT_EQ(run.robot().wait(0), 0) << run.said();
  EXPECT_TRUE(run.robot_json().at("survived"));
  EXPECT_GT(run.robot_json().at("steps").size(), 8u);
  EXPECT_NEAR(run.robot_json().at("mean_speed_m_s").get<double>(), 0.5, 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    TwoProcesses, WalkWithTorsoSensor,
    testing::Values(
        Sensor{"EncoderWithoutSpeed", {"device=canopen_encoder"}},
        Sensor{"EncoderAtHalfTheRate",
               {"device=canopen_encoder", "encoder_ratio=2", "encoder_turns=4096", "encoder_reversed=true"}},
        Sensor{"EncoderWithSpeed", {"device=canopen_encoder", "encoder_speed_rad_s=0.001"}},
        Sensor{"ExtraEncoderOfAMoteus",
               {"encoder_joint=0", "encoder_number=1", "encoder_reversed=true", "encoder_offset_rad=0.15",
                "hip_driver.protocol=moteus", "knee_driver.protocol=moteus"}},
        Sensor{"Xsens", {"device=xsens_can", "rate_hz=400", "imu_axis=roll"}}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(TwoProcesses, TheLongestWindowOfTheRateWalksThroughAPushOf40N) {
  RobotAndController run;
  const Words encoder{"device=canopen_encoder", "rate_window_s=0.05"};
  run.start_robot(with_settings({"--lockstep", "--once", "--duration", "8", "--push", "40@3+1"}, encoder));
  run.start_controller(with_settings({"--lockstep", "--start", "walk@0.5"}, encoder));
  run.expect_both_to_end();
  EXPECT_TRUE(run.robot_json().at("survived")) << run.said();
  EXPECT_GT(run.robot_json().at("mean_speed_m_s").get<double>(), 0.3) << run.said();
}

TEST(TwoProcesses, AnEncoderThatFallsSilentDampsTheRobot) {
  RobotAndController run;
  const Words encoder{"device=canopen_encoder"};
  run.start_robot(with_settings({"--lockstep", "--once", "--fault", "base-silent@1"}, encoder));
  run.start_controller(with_settings({"--lockstep", "--start", "stand", "--duration", "6"}, encoder));
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << run.said();
  // A missed reply before it is reported, too.
  const nlohmann::json controller = run.controller_json();
  EXPECT_EQ(controller.at("last_state"), "fault");
  EXPECT_TRUE(std::ranges::any_of(controller.at("faults"), [](const nlohmann::json& fault) {
    return fault.at("name") == "stale_torso_sensor" && fault.at("reaction") == "damp";
  })) << controller.at("faults");
  EXPECT_NE(text_of(run.file("controller.err")).find("torso sensor: node 32 sends no positions"),
            std::string::npos)
      << run.said();
}

struct Gap {
  const char* name;
  const char* fault;  ///< of fewer missed replies than damp the robot
  Words settings;
};

class GapOfPitches : public testing::TestWithParam<Gap> {};

/// Neither sensor measures a rate: it is that of the pitch, and the gap is longer than its window.
TEST_P(GapOfPitches, HoldsAStandingRobotAndIsOver) {
  RobotAndController run;
  run.start_robot(with_settings({"--lockstep", "--once", "--fault", GetParam().fault}, GetParam().settings));
  run.start_controller(
      with_settings({"--lockstep", "--start", "stand", "--duration", "4"}, GetParam().settings));
  run.expect_both_to_end();
  const nlohmann::json faults = run.controller_json().at("faults");
  EXPECT_EQ(run.controller().wait(0), 0) << faults;
  ASSERT_EQ(faults.size(), 1u) << faults;
  EXPECT_EQ(faults[0].at("name"), "missed_replies") << faults;
  EXPECT_EQ(faults[0].at("reaction"), "hold") << faults;
  EXPECT_TRUE(run.robot_json().at("survived")) << run.said();
}

INSTANTIATE_TEST_SUITE_P(
    TwoProcesses, GapOfPitches,
    testing::Values(Gap{"ChannelAt200", "base-silent@1.5+0.006", {"pitch_rate=none", "rate_hz=200"}},
                    Gap{"ChannelAt500", "base-silent@1.5+0.008", {"pitch_rate=none", "rate_hz=500"}},
                    Gap{"EncoderAt200", "base-silent@1.5+0.006", {"device=canopen_encoder", "rate_hz=200"}},
                    Gap{"EncoderAt500", "base-silent@1.5+0.008", {"device=canopen_encoder", "rate_hz=500"}}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(TwoProcesses, AnEncoderWithOtherStepsIsNamedAndNotRead) {
  RobotAndController run;
  run.start_robot(with_settings({"--lockstep", "--once", "--hang"}, {"device=canopen_encoder"}));
  run.start_command({"watch"}, with_settings({"--lockstep", "--duration", "1"},
                                             {"device=canopen_encoder", "encoder_steps=36000"}));
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 1) << "the torso is silent\n" << run.said();
  EXPECT_NE(
      text_of(run.file("controller.err"))
          .find(
              "torso sensor: node 32 has 65536 steps per turn (object 0x6501:0), torso_sensor.encoder_steps "
              "is 36000"),
      std::string::npos)
      << run.said();
  std::ifstream lines(run.file("controller.json"));
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(nlohmann::json::parse(line).at("torso").at("pitch_rad").is_null()) << line;
}

TEST(TwoProcesses, AScanStartsTheEncoderAndCountsItsPositions) {
  RobotAndController run;
  const Words encoder{"device=canopen_encoder", "bus=1"};
  run.start_robot(with_settings({"--lockstep", "--once", "--hang"}, encoder));
  run.start_command({"scan"}, with_settings({"--lockstep"}, encoder));
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
  EXPECT_NE(text_of(run.file("controller.out")).find("torso sensor: identifier 0x1a0, 1000 per second"),
            std::string::npos)
      << run.said();
}

TEST(TwoProcesses, AVectornavOnASerialPortIsWatched) {
  RobotAndController run;
  const Words imu{"device=vectornav", "serial_port=" + run.file("imu")};
  run.start_robot(with_settings({"--once", "--hang"}, imu));
  run.start_command({"watch"}, with_settings({"--duration", "60"}, imu));
  EXPECT_TRUE(wait_for_text(run.file("controller.json"), "\"pitch_rad\":0.", kLongestRun_s) ||
              wait_for_text(run.file("controller.json"), "\"pitch_rad\":-0.", 0))
      << run.said();
  run.controller().signal(SIGINT);
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
}

TEST(TwoProcesses, AVectornavThatIsSilentMakesAScanIncomplete) {
  RobotAndController run;
  const tests::PseudoTerminal port;
  run.start_robot({"--once", "--hang"});
  run.start_command({"scan"}, with_settings({}, {"device=vectornav", "serial_port=" + port.port()}));
  EXPECT_EQ(run.controller().wait(kLongestRun_s), 1) << run.said();
  EXPECT_NE(text_of(run.file("controller.out")).find("not complete"), std::string::npos) << run.said();
  EXPECT_EQ(run.controller_json().at("complete"), false);
  EXPECT_NE(run.controller_json().at("serial_sensor_trouble"), "");
}

TEST(TwoProcesses, ASerialPortHasNoLockstep) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once", "--hang"});
  run.start_command({"watch"}, with_settings({"--lockstep"}, {"device=vectornav"}));
  EXPECT_EQ(run.controller().wait(kLongestRun_s), 2) << run.said();
  EXPECT_NE(text_of(run.file("controller.err")).find("has no virtual time; omit --lockstep"),
            std::string::npos);
}

}  // namespace
}  // namespace stilt::two_processes
