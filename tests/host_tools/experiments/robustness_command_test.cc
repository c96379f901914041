#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/host_tools/program_test.h"

/// `stilt experiment robustness` as it is typed, with few robots.
namespace stilt::experiments {
namespace {

using Json = nlohmann::json;
using testing_support::Outcome;
using testing_support::text_of;

class RobustnessCommand : public testing_support::ProgramTest {
 protected:
  [[nodiscard]] Outcome walk_robots(const std::string& arguments, const std::string& folder) const {
    return run("experiment robustness " + arguments + " --out " + file(folder));
  }
  [[nodiscard]] std::string text(const std::string& folder, const std::string& name) const {
    return text_of(std::filesystem::path(file(folder)) / name);
  }
};

TEST_F(RobustnessCommand, GivesTheFieldsOfItsContractAndItsPages) {
  const Outcome outcome = walk_robots("--runs 4 --json " + file("json"), "results");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json json = Json::parse(text_of(file("json")));
  EXPECT_EQ(json.at("runs"), 4);
  EXPECT_EQ(json.at("survived"), 4) << json.at("worst");
  EXPECT_LT(json.at("survival").at("low"), json.at("survival").at("value"));
  EXPECT_EQ(json.at("command"), "stilt experiment robustness --runs 4 --out DIR");
  EXPECT_TRUE(json.at("settings").contains("commit"));
  const std::string page = text("results", "robustness.html");
  ASSERT_EQ(json.at("worst").size(), 4u);
  for (const Json& worst : json.at("worst")) {
    for (const char* field : {"seed", "fall_time_s", "changes"}) EXPECT_TRUE(worst.contains(field)) << field;
    EXPECT_EQ(worst.at("changes").size(), json.at("quantities").size() - 1) << "and one combination";
    const auto replay = worst.at("page").get<std::string>();
    EXPECT_NE(page.find("href='" + replay + "'"), std::string::npos) << replay;
    EXPECT_NE(text("results", replay).find(worst.at("command").get<std::string>()), std::string::npos)
        << "the page of a run names its command";
  }
  const std::string commands = text("results", "commands.txt");
  EXPECT_EQ(std::ranges::count(commands, '\n'), 4);
  EXPECT_EQ(commands.find("stilt sim "), 0u) << "a script: what a run came to is a comment behind it";
  EXPECT_NE(commands.find("  # run 3, "), std::string::npos) << commands;
  EXPECT_NE(outcome.output.find(" of 4 random robots stay on their feet"), std::string::npos);
}

TEST_F(RobustnessCommand, TheCommandOfARunRepeatsItsOutcomeToTheLastBit) {
  const std::string robot = file("anna's robot.toml");
  std::ofstream(robot) << "[gait]\nsingle_support_s = 0.32\n";
  const std::string setting = "--runs 2 --seed 9 --config \"" + robot +
                              "\" --plant contact_damping_ratio=0.9 --push-at torso "
                              "--force -35 --horizon 0.8";
  ASSERT_EQ(walk_robots(setting, "results").status, 0) << text_of(file("err"));
  for (const char* name : {"seed9_run0000.json", "seed9_run0001.json"}) {
    const Json expected = Json::parse(text("results", name));
    const auto command = expected.at("command").get<std::string>();
    ASSERT_EQ(command.substr(0, 10), "stilt sim ");
    const Outcome repeated = run(command.substr(6) + " --json -");
    EXPECT_EQ(repeated.status, expected.at("survived").get<bool>() ? 0 : 1) << repeated.errors;
    const Json result = Json::parse(repeated.output);
    for (const char* figure : {"survived", "fall_time_s", "fall_margin_min", "mean_speed_m_s"}) {
      EXPECT_EQ(result.at(figure), expected.at(figure)) << figure << " of " << command;
    }
  }
}

TEST_F(RobustnessCommand, AnExperimentThatGoesOnEqualsOneWithoutInterruptionOnAnyNumberOfCores) {
  ASSERT_EQ(walk_robots("--runs 3 --processes 1 --json " + file("one.json"), "one").status, 0);
  ASSERT_EQ(walk_robots("--runs 3 --job seed1_run0002", "other").status, 0);
  ASSERT_EQ(walk_robots("--runs 1 --processes 3", "other").status, 0) << "a smaller part first";
  ASSERT_EQ(walk_robots("--runs 3 --processes 3 --json " + file("other.json"), "other").status, 0);
  EXPECT_EQ(text_of(file("one.json")), text_of(file("other.json")));
  EXPECT_EQ(text("one", "robustness.html"), text("other", "robustness.html"));
  EXPECT_EQ(text("one", "seed1_run0000.json"), text("other", "seed1_run0000.json"));
}

TEST_F(RobustnessCommand, JobsOfSeveralMachinesAreMerged) {
  EXPECT_EQ(walk_robots("--runs 2 --seed 4 --list-jobs", "results").output, "seed4_run0000\nseed4_run0001\n");
  EXPECT_EQ(walk_robots("--runs 2 --seed 4 --job seed4_run0000", "results").status, 0);
  const Outcome missing = walk_robots("--runs 2 --seed 4 --merge", "results");
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.errors.find("seed4_run0001"), std::string::npos) << missing.errors;
  EXPECT_EQ(walk_robots("--runs 2 --seed 4 --job seed4_run0001", "results").status, 0);
  EXPECT_EQ(walk_robots("--runs 2 --seed 4 --merge", "results").status, 0);
  EXPECT_EQ(walk_robots("--runs 2 --seed 4 --force 50 --merge", "results").status, 2)
      << "results of another push";
}

TEST_F(RobustnessCommand, BadUsageIsOneSentenceAndStatusTwo) {
  for (const std::string arguments :
       {"--runs 0", "--runs many", "--seed -1", "--seed 4294967296", "--force 5000", "--push-at head",
        "--controller nonsense", "--horizon -1", "--plant gravity=1", "--set cost.nothing=1",
        "--job seed1_run9999", "--seeds 3"}) {
    const Outcome outcome = walk_robots(arguments, "results");
    EXPECT_EQ(outcome.status, 2) << arguments << ": " << outcome.errors;
    EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << arguments << ": " << outcome.errors;
  }
}

}  // namespace
}  // namespace stilt::experiments
