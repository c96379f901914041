#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "firmware/configuration/gaits/gait_file.h"
#include "firmware/configuration/gaits/shipped_gaits.h"
#include "firmware/robots/robots.h"
#include "tests/own_folder.h"

namespace stilt::gait_files {
namespace {

class LoadLibrary : public testing::Test {
 protected:
  void write(const char* name, std::string_view text) const { std::ofstream(folder_ / name) << text; }
  [[nodiscard]] std::string error() {
    const auto loaded = load_library(folder_.string(), "amber3m", *library_);
    return loaded ? "" : loaded.error();
  }
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }

  tests::OwnFolder own_;
  std::filesystem::path folder_ = own_.path();
  std::unique_ptr<gait::GaitLibrary> library_ = std::make_unique<gait::GaitLibrary>();
};

TEST_F(LoadLibrary, HasTheShippedGaitsOfAmberFromTheSlowestOn) {
  ASSERT_TRUE(load_shipped_library("amber3m", *library_));
  ASSERT_EQ(library_->count(), 15);
  EXPECT_EQ(library_->gait(0).speed_m_s, -0.4);
  EXPECT_EQ(library_->gait(4).speed_m_s, 0.0);
  EXPECT_EQ(library_->gait(14).speed_m_s, 1.0);
  EXPECT_NEAR(library_->step_time_s(), 0.3, 1e-4);
}

TEST_F(LoadLibrary, SaysThatARobotHasNoGaits) {
  EXPECT_EQ(load_shipped_library("nonsense", *library_).error(), "no gaits of nonsense are shipped");
}

TEST_F(LoadLibrary, SortsTheFilesOfAFolderBySpeed) {
  int name = 100;
  for (const ShippedGait& shipped : shipped_gaits())
    write((std::to_string(name--) + ".toml").c_str(), shipped.text);
  write("notes.txt", "no gait");
  ASSERT_EQ(error(), "");
  EXPECT_EQ(library_->count(), 15);
  for (int i = 1; i < 15; ++i) EXPECT_GT(library_->gait(i).speed_m_s, library_->gait(i - 1).speed_m_s);
}

TEST_F(LoadLibrary, FindsARelativeUrdfFromTheFolderOfTheFile) {
  std::string text(shipped_gaits()[0].text);
  const std::string named = "robot = \"" + std::string(shipped_gaits()[0].robot) + '"';
  ASSERT_NE(text.find(named), std::string::npos);
  write("gait.toml", text.replace(text.find(named), named.size(), "robot = \"robot.urdf\""));
  EXPECT_EQ(error(), path("gait.toml") + ": robot: " + path("robot.urdf") +
                         ": cannot be read (No such file or directory); give the path of a URDF file");
  write("robot.urdf", robots::shipped_urdfs()[0].text);
  EXPECT_EQ(error(),
            path("gait.toml") + ": this is a gait of " + path("robot.urdf") + "; one of amber3m is needed");
  const std::string elsewhere = (folder_ / "." / "robot.urdf").string();
  const auto loaded = load_library(folder_.string(), elsewhere, *library_);
  ASSERT_TRUE(loaded) << loaded.error();
  EXPECT_EQ(library_->count(), 1);
}

TEST_F(LoadLibrary, RefusesFoldersThatMakeNoLibraryAndLeavesItEmpty) {
  EXPECT_EQ(error(),
            folder_.string() + ": no gait files (*.toml) here; name a folder that stilt gait library wrote");
  const std::string_view shipped = shipped_gaits()[0].text;
  write("a.toml", shipped);
  write("b.toml", shipped);
  EXPECT_NE(error().find(": another gait has the same speed; keep one of them"), std::string::npos);
  EXPECT_EQ(library_->count(), 0);
  auto record = parse_gait(shipped, "shipped");
  ASSERT_TRUE(record);
  record->gait.speed_m_s += 0.05;
  record->gait.step_time_s += 0.1;
  write("b.toml", to_toml(*record));
  EXPECT_NE(error().find("step time and degree of the states must be those"), std::string::npos);
  record->robot = "rabbit";
  write("b.toml", to_toml(*record));
  EXPECT_EQ(error(), path("b.toml") + ": this is a gait of rabbit; one of amber3m is needed");
  write("b.toml", "nonsense");
  EXPECT_NE(error().find("b.toml: line 1 is not TOML"), std::string::npos);
}

}  // namespace
}  // namespace stilt::gait_files
