#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "tests/firmware/program/stiltd_answer.h"
#include "tests/own_folder.h"

/// What stiltd reports on a configuration: --check-config and --print-config.
namespace stilt::program {
namespace {

using testing_support::answer;
using testing_support::Answer;
using testing_support::has;
using testing_support::stiltd;

TEST(Stiltd, ChecksAConfigurationWithoutOpeningABus) {
  const Answer run = stiltd("--check-config --config " SHIPPED);
  EXPECT_EQ(run.status, 0);
  EXPECT_TRUE(has(run, "amber3m.toml: valid\nrobot amber3m\nmass 21.56 kg, thigh 0.4064 m, shin 0.4667 m\n"))
      << run.text;
  EXPECT_TRUE(has(run, "bus can1: worst-case load 54 %")) << run.text;
}

TEST(Stiltd, ReportsEveryMistakeOfAConfigurationWithItsPlace) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "[hardware]\nbusses = \"can0\"\n[gait]\nswing_height_m = 9\n";
  const Answer run = stiltd("--check-config --config " + file);
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(has(run, file + ":2:1: unknown key hardware.busses; did you mean hardware.buses?")) << run.text;
  EXPECT_TRUE(has(run, file + ":4:18: gait.swing_height_m = 9 is outside its range")) << run.text;
}

TEST(Stiltd, PrintsTheWholeConfigurationAsItWouldReadIt) {
  const Answer printed = stiltd("--print-config --set hip_L.offset_rad=0.125");
  EXPECT_EQ(printed.status, 0);
  EXPECT_TRUE(has(printed, "offset_rad = 0.125"));
  EXPECT_TRUE(has(printed, "[supervisor]"));
  EXPECT_TRUE(has(printed, "[discretisation]"));
}

/// A value that follows from another would stay when the other is changed in the file.
TEST(Stiltd, PrintsNoValueThatFollowsFromAnother) {
  const Answer limited = stiltd("--print-config --set supervisor.torque_limit_share=0.3");
  EXPECT_TRUE(has(limited, "\ntorque_limit_share = 0.3\n")) << limited.text;
  EXPECT_TRUE(has(limited, "\ntorque_limit_scale = 1.0\n"));
  EXPECT_TRUE(has(limited, "\ncatch_falls = true\n"));
  const Answer usual = stiltd("--print-config");
  Answer planned = stiltd("--print-config --set controller.reference=hzd");
  const std::string chosen = "\nreference = \"hzd\"\n";
  const std::size_t place = planned.text.find(chosen);
  ASSERT_NE(place, std::string::npos);
  planned.text.replace(place, chosen.size(), "\nreference = \"heuristic\"\n");
  EXPECT_EQ(planned.text, usual.text) << "weights and step times of the gaits";
}

TEST(Stiltd, ChecksAConfigurationAsTheControllerTakesIt) {
  for (const auto& [set, sentence] :
       {std::pair{"--robot rabbit --set supervisor.select_gait=true", "; set it to false\n"},
        std::pair{"--set controller.reference=hzd --set cost.base_x=0",
                  "the weights in cost admit no terminal"},
        std::pair{"--set sqp.instruction_set=neon", "sqp.instruction_set"}}) {
    const Answer run = stiltd(std::string("--check-config ") + set);
    EXPECT_EQ(run.status, 2) << set;
    EXPECT_TRUE(has(run, sentence)) << set << run.text;
    EXPECT_FALSE(has(run, ": valid\n")) << set;
  }
}

/// As docs/first-day.md begins with a robot of one's own; it has no configuration beside it.
TEST(Stiltd, PrintsTheConfigurationOfAUrdfWithTheStanceOfItsLegs) {
  const tests::OwnFolder folder;
  std::filesystem::copy_file(
      std::filesystem::path(SHIPPED).parent_path() / "../../codegen/robots/rabbit.urdf",
      folder.path() / "mine.urdf");
  const Answer printed =
      answer("cd " + folder.path().string() + " && " STILTD " --print-config --robot mine.urdf 2>&1");
  EXPECT_EQ(printed.status, 0);
  EXPECT_TRUE(has(printed, "\nrobot = \"mine.urdf\"\n"));
  EXPECT_TRUE(has(printed, "\nbase_height_m = 0.73")) << "legs of 0.8 m";
}

// As a service does, which starts in /.
TEST(Stiltd, FindsTheUrdfOfAConfigurationFromAnyWorkingDirectory) {
  const tests::OwnFolder folder;
  std::filesystem::copy_file(
      std::filesystem::path(SHIPPED).parent_path() / "../../codegen/robots/amber3m.urdf",
      folder.path() / "mine.urdf");
  std::ofstream(folder.path() / "robot.toml") << "[hardware]\nrobot = \"mine.urdf\"\n";
  const auto from = [](const std::string& directory, const std::string& arguments) {
    return answer("cd " + directory + " && " STILTD " " + arguments + " 2>&1");
  };
  const std::string here = folder.path().string(), file = folder.file("robot.toml");
  const Answer root = from("/", "--check-config --config " + file);
  EXPECT_EQ(root.status, 0) << root.text;
  EXPECT_TRUE(has(root, "\nrobot " + folder.file("mine.urdf") + "\n")) << root.text;
  EXPECT_EQ(from(here, "--check-config --config robot.toml").status, 0);
  EXPECT_EQ(from(here, "--check-config --robot mine.urdf").status, 0);
  EXPECT_EQ(from("/", "--check-config --config " + file + " --robot mine.urdf").status, 2);
  EXPECT_TRUE(has(from(here, "--print-config --config robot.toml"), "\nrobot = \"mine.urdf\"\n"));
  EXPECT_TRUE(
      has(from("/", "--print-config --config " + file), "\nrobot = \"" + folder.file("mine.urdf") + "\"\n"));
}

TEST(Stiltd, TakesAFolderWithAnyNameInUtf8) {
  const tests::OwnFolder folder;
  const std::string here = folder.path().string() + "/j\xc3\xbcrgen \xe6\xad\xa9";
  std::filesystem::create_directory(here);
  std::filesystem::copy_file(
      std::filesystem::path(SHIPPED).parent_path() / "../../codegen/robots/amber3m.urdf",
      here + "/mine.urdf");
  std::ofstream(here + "/robot.toml") << "[hardware]\nrobot = \"mine.urdf\"\n";
  const Answer checked = stiltd("--check-config --config '" + here + "/robot.toml'");
  EXPECT_EQ(checked.status, 0) << checked.text;
  EXPECT_TRUE(has(checked, "\nrobot " + here + "/mine.urdf\n")) << checked.text;
  for (const char* damaged : {"\xff", "\xc3", "\xc3(", "\x80", "\xe6\xad"}) {
    const Answer run = stiltd(std::string("--check-config --set 'hardware.robot=") + damaged + ".urdf'");
    EXPECT_EQ(run.status, 2) << damaged;
    EXPECT_TRUE(has(run, "must be UTF-8 without quotes")) << run.text;
  }
}

}  // namespace
}  // namespace stilt::program
