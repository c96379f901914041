#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/host_tools/program_test.h"

namespace stilt::cli {
namespace {

using testing_support::Outcome;
using testing_support::text_of;

constexpr const char* kOld = "# mine\n[sqp]\ng_max = 1e5  # wide\n\n[base_sensor]\nrate_hz = 250.0\n";
constexpr const char* kNew =
    "# mine\n[sqp]\nfilter_violation_max = 1e5  # wide\n\n[torso_sensor]\nrate_hz = 250.0\n";

class ConfigMigrate : public testing_support::ProgramTest {
 protected:
  /// A file of that text in the test's folder.
  [[nodiscard]] std::string written(const std::string& name, const std::string& text) const {
    std::ofstream(file(name), std::ios::binary) << text;
    return file(name);
  }
};

TEST_F(ConfigMigrate, RewritesAFileInPlaceAndPrintsWhatChanged) {
  const std::string path = written("mine.toml", kOld);
  const Outcome outcome = run("config migrate " + path);
  EXPECT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(text_of(path), kNew);
  EXPECT_EQ(outcome.output, path + ":3:1: g_max is now filter_violation_max\n" + path +
                                ":5:2: base_sensor is now torso_sensor\n");
}

TEST_F(ConfigMigrate, AnOldFileIsRefusedUntilItIsMigrated) {
  const std::string path = written("mine.toml", kOld);
  const Outcome refused = run("sim --duration 0.02 --config " + path);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.errors.find(path + ":3:1: g_max is now filter_violation_max; stilt config migrate " +
                                path + " rewrites the file"),
            std::string::npos)
      << refused.errors;
  ASSERT_EQ(run("config migrate " + path).status, 0);
  const Outcome taken = run("sim --duration 0.02 --config " + path);
  EXPECT_EQ(taken.status, 0) << taken.errors;
}

TEST_F(ConfigMigrate, OutLeavesTheFileAsItIs) {
  const std::string path = written("mine.toml", kOld);
  EXPECT_EQ(run("config migrate " + path + " --out " + file("new.toml")).status, 0);
  EXPECT_EQ(text_of(path), kOld);
  EXPECT_EQ(text_of(file("new.toml")), kNew);
}

TEST_F(ConfigMigrate, OutInAnotherFolderNamesTheSameRobot) {
  const std::string path = written("mine.toml", std::string(kOld) + "[hardware]\nrobot = \"mine.urdf\"\n");
  std::filesystem::create_directory(file("below"));
  ASSERT_EQ(run("config migrate " + path + " --out " + file("below/new.toml")).status, 0);
  EXPECT_EQ(text_of(file("below/new.toml")),
            std::string(kNew) + "[hardware]\nrobot = \"" + file("mine.urdf") + "\"\n");
  ASSERT_EQ(run("config migrate " + path + " --out " + file("new.toml")).status, 0);
  EXPECT_EQ(text_of(file("new.toml")), std::string(kNew) + "[hardware]\nrobot = \"mine.urdf\"\n");
}

TEST_F(ConfigMigrate, AFileWithoutOldNamesIsNotWritten) {
  const std::string path = written("mine.toml", kNew);
  struct stat before = {};
  struct stat after = {};
  ASSERT_EQ(stat(path.c_str(), &before), 0);
  const Outcome outcome = run("config migrate " + path);
  ASSERT_EQ(stat(path.c_str(), &after), 0);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.output, path + ": nothing to rename\n");
  EXPECT_EQ(before.st_ino, after.st_ino);
  EXPECT_EQ(text_of(path), kNew);
}

TEST_F(ConfigMigrate, LinksAndPermissionsStay) {
  const std::string path = written("mine.toml", kOld);
  ASSERT_EQ(chmod(path.c_str(), 0640), 0);
  ASSERT_EQ(symlink(path.c_str(), file("link.toml").c_str()), 0);
  ASSERT_EQ(run("config migrate " + file("link.toml")).status, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(file("link.toml")));
  EXPECT_EQ(text_of(path), kNew);
  struct stat after = {};
  ASSERT_EQ(stat(path.c_str(), &after), 0);
  EXPECT_EQ(after.st_mode & 0777, 0640u);
}

/// The FIFO stays open here, so that neither side waits for the other.
TEST_F(ConfigMigrate, AFifoGetsTheTextAndStaysOne) {
  const std::string path = written("mine.toml", kOld);
  const std::string fifo = file("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const int reader = open(fifo.c_str(), O_RDWR | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  EXPECT_EQ(run("config migrate " + path + " --out " + fifo).status, 0);
  EXPECT_TRUE(std::filesystem::is_fifo(fifo));
  std::string got(1000, '\0');
  const ssize_t size = read(reader, got.data(), got.size());
  got.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  close(reader);
  EXPECT_EQ(got, kNew);
}

TEST_F(ConfigMigrate, ADashIsStandardOutputWithTheTextAlone) {
  const Outcome outcome = run("config migrate " + written("mine.toml", kOld) + " --out -");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.output, kNew);
  EXPECT_NE(outcome.errors.find("g_max is now filter_violation_max"), std::string::npos) << outcome.errors;
}

TEST_F(ConfigMigrate, AFullDiskLeavesNothing) {
  const std::string path = written("mine.toml", kOld);
  EXPECT_EQ(run("config migrate " + path + " --out /dev/full").status, 2);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
  EXPECT_EQ(text_of(path), kOld);
}

TEST_F(ConfigMigrate, WhatCannotBeReadOrWrittenIsOneSentenceAndStatusTwo) {
  const std::string good = written("good.toml", kOld);
  const std::string both = written("both.toml", "[sqp]\ng_max = 1\nfilter_violation_max = 2\n");
  for (const std::string& arguments :
       {std::string("no/such.toml"), std::filesystem::temp_directory_path().string(),
        written("bad.toml", "[sqp\n"), good + " --out /nowhere/new.toml", both}) {
    const Outcome outcome = run("config migrate " + arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_EQ(outcome.output, "") << arguments;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
  }
  EXPECT_EQ(text_of(good), kOld);
}

}  // namespace
}  // namespace stilt::cli
