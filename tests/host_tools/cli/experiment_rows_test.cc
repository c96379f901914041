#include "host_tools/cli/experiment_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "host_tools/cli/usage_error.h"
#include "tests/host_tools/program_test.h"

namespace stilt::cli {
namespace {

class ExperimentRows : public testing_support::ProgramTest {
 protected:
  [[nodiscard]] std::vector<RowChoice> rows(const std::string& text, const RowChoice& defaults = {}) const {
    std::ofstream(file("rows.toml")) << text;
    return read_rows(file("rows.toml"), defaults);
  }

  /// What read_rows says about a text; empty when it accepts it.
  [[nodiscard]] std::string mistake(const std::string& text) const {
    try {
      (void)rows(text);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(ExperimentRows, EveryKeyOfARowIsRead) {
  const std::string gaits = std::filesystem::path(SHIPPED_GAITS).string();
  const auto all = rows(R"(
[[row]]
name = "first_1.0"
robot = "amber3m"
controller = "mpc-hzd"
horizon_s = 0.5
preset = "paper"
set = ["cost.terminal=2", "sqp.iterations=7"]
plant = ["friction=0.3"]
gaits = ")" + gaits + R"("
push_at = "torso"
direction = "backward"
gait = "step"
speed_m_s = 0.3
plan_rate_hz = 200
plan_delay_s = 0.003
state = "truth"
phases = 4
seeds = 2
coarse_N = 5
[[row]]
name = "second"
controller = "mpc-lumped"
lump = "legs"
)");
  ASSERT_EQ(all.size(), 2u);
  const RowChoice& row = all[0];
  const ControllerChoice& choice = row.setting.choice;
  EXPECT_EQ(row.name, "first_1.0");
  EXPECT_EQ(choice.robot, "amber3m");
  EXPECT_EQ(choice.controller, "mpc-hzd");
  EXPECT_EQ(choice.horizon_s, 0.5);
  EXPECT_EQ(choice.preset, "paper");
  EXPECT_EQ(choice.settings, (std::vector<std::string>{"cost.terminal=2", "sqp.iterations=7"}));
  EXPECT_EQ(row.setting.plant_settings, std::vector<std::string>{"friction=0.3"});
  EXPECT_EQ(choice.gait_folder, gaits);
  EXPECT_EQ(all[1].setting.choice.lump, "legs");
  EXPECT_EQ(row.setting.push_point, "torso");
  EXPECT_EQ(row.direction, "backward");
  EXPECT_EQ(row.gait, "step");
  EXPECT_EQ(row.speed_m_s, 0.3);
  EXPECT_EQ(choice.plan_rate_hz, 200.0);
  EXPECT_EQ(choice.plan_delay_s, 0.003);
  EXPECT_EQ(row.setting.state, "truth");
  EXPECT_EQ(row.phases, 4);
  EXPECT_EQ(row.seeds, 2);
  EXPECT_EQ(row.coarse_N, 5.0);
}

TEST_F(ExperimentRows, WhatARowLeavesOutIsThatOfTheOptions) {
  RowChoice defaults;
  defaults.setting.choice.settings = {"sqp.iterations=7"};
  defaults.setting.choice.gait_folder = "/nowhere";
  defaults.setting.push_point = "torso";
  defaults.direction = "backward";
  defaults.seeds = 5;
  const auto all = rows(R"(
[[row]]
name = "a"
[[row]]
name = "b"
set = ["cost.terminal=2"]
push_at = "hip"
seeds = 1
)",
                        defaults);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].setting.push_point, "torso");
  EXPECT_EQ(all[0].seeds, 5);
  EXPECT_EQ(all[1].direction, "backward");
  EXPECT_EQ(all[1].setting.push_point, "hip");
  EXPECT_EQ(all[1].seeds, 1);
  EXPECT_EQ(all[1].setting.choice.settings, (std::vector<std::string>{"sqp.iterations=7", "cost.terminal=2"}))
      << "those of the row count last";
  EXPECT_EQ(all[0].setting.choice.gait_folder, "") << "mpc-heuristic follows no gaits";
}

TEST_F(ExperimentRows, AMistakeIsOneSentenceThatNamesFileRowAndKey) {
  struct Mistake {
    const char* line;
    const char* key;
    const char* right;
  };
  for (const Mistake& wrong : {Mistake{"robot = \"dog\"", "robot", "amber3m"},
                               {"controller = \"mpc-best\"", "controller", "mpc-heuristic"},
                               {"controller = 5", "controller", "mpc-heuristic"},
                               {"horizon_s = 9.0", "horizon_s", "2"},
                               {"horizon_s = \"long\"", "horizon_s", "number"},
                               {"horizon_s = nan", "horizon_s", "number"},
                               {"preset = \"nonsense\"", "preset", "paper"},
                               {"set = [\"cost.nothing=1\"]", "set", "cost.nothing"},
                               {"set = \"cost.terminal=1\"", "set", "list"},
                               {"set = [1]", "set", "list"},
                               {"plant = [\"friction=99\"]", "plant", "0.01"},
                               {"controller = \"mpc-hzd\"\ngaits = \"/nowhere\"", "gaits", "/nowhere"},
                               {"gaits = \"/nowhere\"", "gaits", "mpc-hzd"},
                               {"lump = \"feet\"", "lump", "drives"},
                               {"push_at = \"head\"", "push_at", "torso"},
                               {"direction = \"up\"", "direction", "backward"},
                               {"gait = \"trot\"", "gait", "stand"},
                               {"speed_m_s = 6.0", "speed_m_s", "5"},
                               {"speed_m_s = true", "speed_m_s", "number"},
                               {"plan_rate_hz = 0.0", "plan_rate_hz", "1 to 2000 Hz"},
                               {"plan_delay_s = -1.0", "plan_delay_s", "0"},
                               {"state = \"guessed\"", "state", "truth"},
                               {"phases = 0", "phases", "1"},
                               {"seeds = 1.5", "seeds", "whole"},
                               {"coarse_N = 0.5", "coarse_N", "1"},
                               {"colour = \"red\"", "colour", "horizon_s"}}) {
    const std::string sentence =
        mistake(std::string("[[row]]\nname = \"good\"\n[[row]]\nname = \"bad\"\n") + wrong.line + "\n");
    EXPECT_NE(sentence.find("rows.toml, row bad, " + std::string(wrong.key) + ": "), std::string::npos)
        << wrong.line << ": " << sentence;
    EXPECT_NE(sentence.find(wrong.right), std::string::npos) << wrong.line << ": " << sentence;
    EXPECT_EQ(std::ranges::count(sentence, '\n'), 0) << sentence;
  }
}

TEST_F(ExperimentRows, ARowNeedsANameOfItsOwn) {
  EXPECT_NE(mistake("[[row]]\nphases = 1\n").find("row number 1, name:"), std::string::npos);
  EXPECT_NE(mistake("[[row]]\nname = 3\n").find("row number 1, name:"), std::string::npos);
  EXPECT_NE(mistake("[[row]]\nname = \"../a\"\n").find(", name:"), std::string::npos);
  EXPECT_NE(mistake("[[row]]\nname = \"\"\n").find(", name:"), std::string::npos);
  EXPECT_NE(mistake("[[row]]\nname = \"a\"\n[[row]]\nname = \"a\"\n").find("row a, name: another row"),
            std::string::npos);
}

TEST_F(ExperimentRows, AFileHoldsRowsAndNothingBesides) {
  for (const char* text : {"", "row = 1\n", "row = []\n", "[row]\nname = \"a\"\n", "row = [1]\n",
                           "colour = \"red\"\n[[row]]\nname = \"a\"\n"}) {
    EXPECT_NE(mistake(text).find("rows.toml: must hold tables [[row]]"), std::string::npos) << text;
  }
  EXPECT_NE(mistake("[[row]]\nname = \n").find("rows.toml, line 2:"), std::string::npos);
  EXPECT_THROW((void)read_rows("/nowhere/rows.toml", {}), UsageError);
}

TEST_F(ExperimentRows, ThePublishedFilesOfRowsAreRight) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PUBLISHED_ROWS)) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW((void)read_rows(entry.path().string(), {})) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 4);
}

}  // namespace
}  // namespace stilt::cli
