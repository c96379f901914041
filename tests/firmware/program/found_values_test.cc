#include "firmware/program/found_values.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/own_folder.h"

namespace stilt::program {
namespace {

const std::vector<configuration::NewValue> kFound = {{"hip_L", "reversed", "true"},
                                                     {"hip_L", "offset_rad", "0.125"}};

std::string content(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

Options options_of(const std::string& robot, const std::string& out) {
  Options options;
  options.configuration = *configuration::load_robot(robot);
  options.out_file = out;
  return options;
}

TEST(FoundValues, ANewFileIsACopyOfWhatWasReadWithTheValues) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  ASSERT_TRUE(write_values(options_of("rabbit", file), kFound));
  const auto read = configuration::load_file(file);
  ASSERT_TRUE(read) << configuration::to_string(read.error());
  EXPECT_EQ(read->hardware.robot, "rabbit");
  EXPECT_EQ(read->hardware.joint[0].offset_rad, 0.125);
  EXPECT_TRUE(read->hardware.joint[0].reversed);
  EXPECT_EQ(read->gait.single_support_s, configuration::load_robot("rabbit")->gait.single_support_s);
}

TEST(FoundValues, TheFileOfConfigIsTheOneThatIsCopied) {
  const tests::OwnFolder folder;
  Options options = options_of("amber3m", folder.file("new.toml"));
  options.config_file = folder.file("mine.toml");
  std::ofstream(options.config_file) << "# mine\n[hip_L]\nid = 9\nreply_id = 25\n";
  ASSERT_TRUE(write_values(options, kFound));
  const std::string text = content(options.out_file);
  EXPECT_TRUE(text.starts_with("# mine\n[hip_L]\nid = 9\n")) << text;
  EXPECT_EQ(configuration::load_file(options.out_file)->hardware.joint[0].id, 9);
}

TEST(FoundValues, AFileThatIsThereKeepsItsComments) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "# by hand\n[hip_L]\noffset_rad = 3.0 # old\n";
  ASSERT_TRUE(write_values(options_of("amber3m", file), kFound));
  EXPECT_EQ(content(file), "# by hand\n[hip_L]\noffset_rad = 0.125 # old\nreversed = true\n");
}

/// Options of the command line `stiltd ... --out FILE`.
std::expected<Options, std::string> read(std::vector<std::string> words) {
  words.insert(words.begin(), "stiltd");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  Options options;
  const auto right = read_options(static_cast<int>(pointers.size()), pointers.data(), "version", options);
  if (!right) return std::unexpected(right.error());
  return options;
}

TEST(FoundValues, WhatTheCommandLineSetsIsWrittenWithThem) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  const auto options =
      read({"calibrate", "--out", file, "--preset", "paper", "--set", "hip_driver.ratio = 1.5", "--set",
            "hip_L.offset_rad=7", "--bus", "loopback:left", "--bus", "loopback:right"});
  ASSERT_TRUE(options) << options.error();
  ASSERT_TRUE(write_values(*options, kFound));
  const auto read = configuration::load_file(file);
  ASSERT_TRUE(read) << configuration::to_string(read.error());
  EXPECT_EQ(read->hardware.hip.ratio, 1.5);
  EXPECT_EQ(read->hardware.buses, "loopback:left,loopback:right");
  EXPECT_EQ(read->hardware.joint[0].offset_rad, 0.125) << "found, and not the one of the command line";
  const auto paper = configuration::load_robot("amber3m", {}, "paper");
  EXPECT_EQ(read->sqp.plan_defect_max, paper->sqp.plan_defect_max);
  EXPECT_NE(read->sqp.plan_defect_max, configuration::load_robot("amber3m")->sqp.plan_defect_max);
  EXPECT_NE(written_text(*options).find("what the command line sets: "), std::string::npos);
  EXPECT_NE(written_text(*options).find("hip_driver.ratio"), std::string::npos);
}

TEST(FoundValues, AFileThatIsNoConfigurationIsRefusedBeforeTheRun) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  EXPECT_TRUE(check_out_file(options_of("amber3m", file))) << "it is not there yet";
  std::ofstream(file) << "[hip_L]\noffset_rad = far\n";
  const auto checked = check_out_file(options_of("amber3m", file));
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().find(file + ":2:"), std::string::npos) << checked.error();
}

TEST(FoundValues, AFileWithDotsAndBracesGetsThem) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "hip_L.id = 9\nhip_L.reply_id = 25\nknee_L = { offset_rad = 0.5 }\n";
  for (const char* command : {"calibrate", "identify"}) {
    const auto options = read({command, "--config", file, "--out", file});
    ASSERT_TRUE(options) << options.error();
    const auto checked = check_out_file(*options);
    EXPECT_TRUE(checked) << command << checked.error();
  }
  std::vector<configuration::NewValue> found = kFound;
  found.push_back({"knee_L", "reversed", "true"});
  const auto written = write_values(*read({"calibrate", "--config", file, "--out", file}), found);
  ASSERT_TRUE(written) << written.error();
  EXPECT_EQ(content(file),
            "hip_L.id = 9\nhip_L.reply_id = 25\nhip_L.reversed = true\nhip_L.offset_rad = 0.125\n"
            "knee_L = { offset_rad = 0.5, reversed = true }\n");
  EXPECT_EQ(configuration::load_file(file)->hardware.joint[0].offset_rad, 0.125);
}

TEST(FoundValues, ANewFileIsTriedBeforeTheRun) {
  const tests::OwnFolder folder;
  Options options = options_of("amber3m", folder.file("new.toml"));
  options.task = Task::calibrate;
  EXPECT_TRUE(check_out_file(options));
  EXPECT_FALSE(std::filesystem::exists(options.out_file));
  options.config_file = folder.file("gone.toml");
  const auto checked = check_out_file(options);
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().find("gone.toml cannot be read"), std::string::npos) << checked.error();
}

TEST(FoundValues, AFileWithAnotherWiringIsRefusedBeforeTheRun) {
  const tests::OwnFolder folder;
  const std::string here = folder.file("mine.toml"), there = folder.file("other.toml");
  const auto checked = [&](const std::string& mine, const std::string& other,
                           const std::vector<std::string>& more = {}) {
    std::ofstream(here) << mine;
    std::ofstream(there) << other;
    std::vector<std::string> words = {"calibrate", "--config", here, "--out", there};
    words.insert(words.end(), more.begin(), more.end());
    const auto options = read(words);
    EXPECT_TRUE(options) << options.error();
    const auto result = check_out_file(*options);
    return result ? std::string() : result.error();
  };
  const std::string ratio = "[hip_driver]\nratio = 2\n";
  EXPECT_EQ(
      checked(ratio, ""),
      "--out " + there +
          ": hip_driver.ratio is 1.0 there and 2.0 in this run, and what is found belongs to one wiring; "
          "take --config " +
          there + ", or a new file for --out");
  for (const char* wiring : {"[hardware]\nbuses = \"can2,can3\"\n", "[hip_L]\nid = 9\nreply_id = 25\n",
                             "[knee_R]\ntorque_factor = 0.95\n", "[torso_sensor]\nrate_hz = 400\n"}) {
    EXPECT_NE(checked(wiring, ""), "") << wiring;
    EXPECT_NE(checked("", wiring), "") << wiring;
    EXPECT_EQ(checked(wiring, wiring), "") << wiring;
  }
  EXPECT_EQ(checked("[hip_L]\noffset_rad = 1\n", "[hip_L]\nreversed = true\n"), "")
      << "calibrate finds these";
  EXPECT_EQ(checked("", "[gait]\nswing_height_m = 0.06\n"), "");
  EXPECT_EQ(checked("", "", {"--set", "hip_driver.ratio=2"}), "") << "it is written with the values";
  EXPECT_EQ(checked(ratio, "", {"--set", "hip_driver.ratio=1.5"}), "");
}

TEST(FoundValues, WithoutConfigTheFileMustHaveTheShippedWiring) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "[hip_R]\nid = 9\n";
  const auto shipped = check_out_file(*read({"identify", "--out", file}));
  ASSERT_FALSE(shipped);
  EXPECT_NE(shipped.error().find("hip_R.id is 9 there and 3 in this run"), std::string::npos)
      << shipped.error();
  EXPECT_TRUE(check_out_file(*read({"identify", "--config", file, "--out", file})));
}

TEST(FoundValues, TheFileBesideAUrdfIsOfThatRobot) {
  const tests::OwnFolder folder;
  const std::string urdf = folder.file("mine.urdf"), beside = folder.file("mine.toml");
  std::filesystem::copy_file(
      std::filesystem::path(SHIPPED).parent_path() / "../../codegen/robots/amber3m.urdf", urdf);
  std::ofstream(beside) << "[hip_R]\nid = 9\n";
  EXPECT_TRUE(check_out_file(*read({"calibrate", "--robot", urdf, "--out", beside})));
  const std::string other = folder.file("other.toml");
  std::ofstream(other) << "[hip_R]\nid = 9\n";
  const auto checked = check_out_file(*read({"calibrate", "--robot", urdf, "--out", other}));
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().find("hardware.robot is \"amber3m\" there"), std::string::npos)
      << checked.error();
}

TEST(FoundValues, AFileNamesARelativeUrdfFromItsOwnFolder) {
  const tests::OwnFolder folder;
  std::filesystem::copy_file(
      std::filesystem::path(SHIPPED).parent_path() / "../../codegen/robots/amber3m.urdf",
      folder.path() / "mine.urdf");
  const std::string mine = folder.file("mine.toml"), fresh = folder.file("fresh.toml");
  std::ofstream(mine) << "[hardware]\nrobot = \"mine.urdf\"\n";
  const std::string relative = std::filesystem::proximate(folder.path()).string();
  const auto options = read({"calibrate", "--config", relative + "/mine.toml", "--out", mine});
  ASSERT_TRUE(options) << options.error();
  EXPECT_TRUE(check_out_file(*options)) << "one URDF under two names";
  const auto changed =
      read({"calibrate", "--config", mine, "--robot", relative + "/mine.urdf", "--out", fresh});
  ASSERT_TRUE(changed) << changed.error();
  ASSERT_TRUE(write_values(*changed, kFound));
  EXPECT_NE(content(fresh).find("robot = \"mine.urdf\"\n"), std::string::npos) << content(fresh);
  EXPECT_TRUE(check_out_file(*changed));
}

TEST(FoundValues, NothingIsWrittenThatWouldBeRefused) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  const std::vector<configuration::NewValue> far = {{"hip_L", "offset_rad", "1e6"}};
  const auto written = write_values(options_of("amber3m", file), far);
  ASSERT_FALSE(written);
  EXPECT_TRUE(written.error().starts_with("--out: what is found makes no valid configuration"))
      << written.error();
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace stilt::program
