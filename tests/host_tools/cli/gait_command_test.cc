#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace stilt::cli {
namespace {

struct Outcome {
  int status = -1;
  std::string output, errors;
};

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

class GaitCommand : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) / (std::string("stilt_gait_") + info->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string file(const char* name) const { return (folder_ / name).string(); }
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    const std::string command = std::string(STILT_PROGRAM) + " gait " + arguments + " </dev/null >" +
                                file("out") + " 2>" + file("err");
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(file("out")), text_of(file("err"))};
  }
  std::filesystem::path folder_;
};

const std::string kShipped = STILT_GAITS "/amber3m_0.50.toml";

TEST_F(GaitCommand, CheckWritesTheFieldsOfTheContract) {
  const Outcome outcome = run("check " + kShipped + " --json");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const auto json = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(json.at("valid"), true);
  EXPECT_EQ(json.at("speed_m_s"), 0.5);
  for (const char* field : {"step_time_s", "step_length_m", "defect_max", "periodicity_error",
                            "return_map_spectral_radius", "friction_ratio_max", "clearance_m"}) {
    EXPECT_TRUE(json.at(field).is_number()) << field;
  }
  EXPECT_EQ(json.at("peak_torque_Nm").size(), 4u);
  EXPECT_TRUE(json.at("violations").empty());
}

TEST_F(GaitCommand, CheckOfAGaitThatBreaksItsLimitsIsStatusOneAndNamesThem) {
  std::string text = text_of(kShipped);
  const std::string limit = "torque_Nm = 60.0";
  const std::size_t at = text.find(limit);
  ASSERT_NE(at, std::string::npos);
  std::ofstream(file("weak.toml")) << text.replace(at, limit.size(), "torque_Nm = 20.0");
  const Outcome outcome = run("check " + file("weak.toml") + " --json");
  EXPECT_EQ(outcome.status, 1);
  const auto json = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(json.at("valid"), false);
  EXPECT_EQ(json.at("violations"), nlohmann::json({"torque_Nm"}));
}

TEST_F(GaitCommand, SynthesizesChecksAndShowsAGait) {
  ASSERT_EQ(run("synthesize --speed 0.35 --out " + file("a.toml")).status, 0);
  EXPECT_EQ(run("check " + file("a.toml")).status, 0);
  EXPECT_EQ(run("show " + file("a.toml") + " --report " + file("a.html")).status, 0);
  EXPECT_NE(text_of(file("a.html")).find("<svg"), std::string::npos);
}

TEST_F(GaitCommand, MakesALibraryWithOneFileASpeed) {
  ASSERT_EQ(run("library --from -0.1 --to 0.1 --step 0.1 --out " + file("library")).status, 0);
  for (const char* name : {"amber3m_-0.10.toml", "amber3m_0.00.toml", "amber3m_0.10.toml"}) {
    EXPECT_EQ(run("check " + file("library") + "/" + name).status, 0) << name;
  }
}

TEST_F(GaitCommand, CompletesAGaitFromElsewhere) {
  const std::string text = text_of(kShipped);
  const std::size_t outputs = text.find("[outputs]");
  const std::size_t feedback = text.find("[feedback]");
  std::ofstream(file("bare.toml")) << "format = 1\nrobot = \"amber3m\"\n"
                                   << text.substr(outputs, feedback - outputs);
  ASSERT_EQ(run("complete " + file("bare.toml") + " --out " + file("full.toml")).status, 0);
  EXPECT_EQ(run("check " + file("full.toml")).status, 0);
}

TEST_F(GaitCommand, BadInputIsOneSentenceAndStatusTwo) {
  const std::vector<std::string> mistakes = {
      "",
      "check /nowhere.toml",
      "synthesize --speed 0.5",
      "synthesize --speed 9 --out " + file("x"),
      "synthesize --speed 0 --phase hip --out " + file("x"),
      "synthesize --speed 0.5 --cost joy --out " + file("x"),
      "synthesize --speed 0.5 --limit torque=3 --out " + file("x"),
      "synthesize --speed 0.5 --out /nowhere/at/all.toml",
      "synthesize --robot nobody --speed 0.5 --out " + file("x"),
      "library --from 1 --to 0 --out " + file("x"),
  };
  for (const std::string& arguments : mistakes) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << ": " << outcome.errors;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1)
        << arguments << outcome.errors;
  }
}

TEST_F(GaitCommand, SaysSoWithStatusOneWhenThereIsNoGait) {
  const Outcome outcome = run("synthesize --speed 0.5 --limit knee_min_rad=3 --out " + file("x"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.errors.find("no gait at 0.5 m/s: the limits contradict"), std::string::npos)
      << outcome.errors;
  EXPECT_FALSE(std::filesystem::exists(file("x")));
}

}  // namespace
}  // namespace stilt::cli
