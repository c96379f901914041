#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/host_tools/program_test.h"

/// `stilt experiment` as it is typed, a small part of each experiment.
namespace stilt::experiments {
namespace {

using Json = nlohmann::json;
using testing_support::Outcome;
using testing_support::text_of;

class ExperimentCommand : public testing_support::ProgramTest {
 protected:
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    return ProgramTest::run(std::string("experiment ").append(arguments));
  }
  [[nodiscard]] Json json() const { return Json::parse(text_of(file("json"))); }
};

TEST_F(ExperimentCommand, FrequencyGivesTheFieldsOfItsContract) {
  const Outcome outcome = run("frequency --quick --out " + file("results") + " --json " + file("json"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json result = json();
  const Json& rows = result.at("rows");
  ASSERT_EQ(rows.size(), 4u);
  const double paper_hz[] = {270.0, 480.0, 670.0, 850.0};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(rows[i].at("paper_hz"), paper_hz[i]);
    EXPECT_GT(rows[i].at("rate_hz").get<double>(), 0.0);
    EXPECT_GT(rows[i].at("rate_early_stop_hz").get<double>(), 0.0);
    EXPECT_GE(rows[i].at("iterations_mean").get<double>(), 1.0);
    EXPECT_LE(rows[i].at("iterations_mean").get<double>(), 10.0);
  }
  EXPECT_NE(outcome.output.find("| 2.0 |"), std::string::npos);
  EXPECT_NE(outcome.errors.find("quick: few cases in coarse steps, so figures differ from docs/results.md"),
            std::string::npos)
      << outcome.errors;
}

TEST_F(ExperimentCommand, DisturbanceGivesTheFieldsOfItsContractAndGoesOnWhereItWas) {
  const std::string command = "disturbance --quick --controller mpc-heuristic --controller hzd-pd --out " +
                              file("results") + " --json " + file("json");
  ASSERT_EQ(run(command).status, 0) << text_of(file("err"));
  const Json first = json();
  ASSERT_EQ(first.at("rows").size(), 2u);
  for (const Json& row : first.at("rows")) {
    for (const char* field : {"name",
                              "robot",
                              "controller",
                              "horizon_s",
                              "gait",
                              "speed_m_s",
                              "push_at",
                              "direction",
                              "plan_rate_hz",
                              "plan_delay_s",
                              "state",
                              "set",
                              "plant",
                              "push_all_phases_N",
                              "push_half_phases_N",
                              "paper_N",
                              "unpushed_speed_m_s",
                              "walks",
                              "cases_walk",
                              "cases",
                              "step_length_range_m",
                              "step_length_at_20N_m",
                              "first_slip_N",
                              "saturated_s",
                              "recovery_steps"}) {
      EXPECT_TRUE(row.contains(field)) << field;
    }
    EXPECT_EQ(row.at("walks"), true);
    EXPECT_NEAR(row.at("unpushed_speed_m_s").get<double>(), 0.5, 0.05);
  }
  const Json& tracked = first.at("rows")[1];
  EXPECT_EQ(tracked.at("controller"), "hzd-pd");
  EXPECT_LT(tracked.at("step_length_range_m").get<double>(), 0.05)
      << "of the gait, not of the start, which takes steps of 0.05 to 0.3 m";
  EXPECT_GE(first.at("rows")[0].at("push_all_phases_N").get<double>(), 40.0);
  const auto one = std::filesystem::path(file("results")) / "mpc-heuristic_0.50s_phase0of2_seed1.json";
  ASSERT_TRUE(std::filesystem::exists(one));
  std::string kept = text_of(one);
  const std::string limit = "\"limit_N\": ";
  kept.at(kept.find(limit) + limit.size()) = '7';  // a result that is there is not computed again
  std::ofstream(one) << kept;
  ASSERT_EQ(run(command).status, 0);
  EXPECT_NE(json(), first);
}

TEST_F(ExperimentCommand, JobsRunOneByOneAndAreMerged) {
  const std::string common = "disturbance --quick --controller mpc-hzd --out " + file("results") + " ";
  const Outcome listed = run(common + "--list-jobs");
  ASSERT_EQ(listed.status, 0);
  EXPECT_EQ(listed.output, "mpc-hzd_0.50s_phase0of2_seed1\nmpc-hzd_0.50s_phase1of2_seed1\n");
  EXPECT_EQ(run(common + "--job mpc-hzd_0.50s_phase0of2_seed1").status, 0);
  EXPECT_EQ(run(common + "--merge").status, 2) << "one result is missing";
  EXPECT_NE(text_of(file("err")).find("mpc-hzd_0.50s_phase1of2_seed1"), std::string::npos);
  EXPECT_EQ(run(common + "--job mpc-hzd_0.50s_phase1of2_seed1").status, 0);
  EXPECT_EQ(run(common + "--merge --json " + file("json")).status, 0);
  EXPECT_EQ(json().at("rows").size(), 1u);
  EXPECT_EQ(json().at("settings").at("preset"), "");
  EXPECT_EQ(run(common + "--preset paper --merge").status, 2) << "results of another setting";
}

TEST_F(ExperimentCommand, DisturbanceRunsTheHorizonsThatAreNamed) {
  const auto rows = [&](const std::string& arguments) {
    const Outcome outcome = run("disturbance --list-jobs --out " + file("results") + " " + arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    std::set<std::string> names;
    std::istringstream lines(outcome.output);
    for (std::string line; std::getline(lines, line);) names.insert(line.substr(0, line.find("_phase")));
    return names;
  };
  using Names = std::set<std::string>;
  EXPECT_EQ(rows("--quick --controller mpc-hzd --horizon 2.0"), Names{"mpc-hzd_2.00s"});
  EXPECT_EQ(rows("--quick --controller mpc-hzd"), Names{"mpc-hzd_0.50s"});
  EXPECT_EQ(rows("--horizon 0.705"), (Names{"hzd-pd", "mpc-lumped_0.705s", "mpc-none_0.705s",
                                            "mpc-heuristic_0.705s", "mpc-hzd_0.705s"}));
}

TEST_F(ExperimentCommand, JobsOfOneNameAreRefused) {
  const std::string limits = "limits --list-jobs --out " + file("results");
  for (const std::string& arguments :
       {limits + " --quantity friction --quantity friction", limits + " --horizon 0.5 --horizon 0.5"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_NE(outcome.errors.find("is there twice; give each value of --controller, --horizon and"),
              std::string::npos)
        << outcome.errors;
  }
  EXPECT_EQ(run(limits + " --quantity friction --horizon 0.501 --horizon 0.504").status, 0);
}

TEST_F(ExperimentCommand, RowsOfAFileArePushedAsTheyAskFor) {
  std::ofstream(file("rows.toml")) << R"(
[[row]]
name = "stand"
gait = "stand"
phases = 1
[[row]]
name = "back"
horizon_s = 0.5
direction = "backward"
push_at = "torso"
plan_rate_hz = 200
state = "truth"
)";
  const Outcome outcome = run("disturbance --quick --rows " + file("rows.toml") + " --out " +
                              file("results") + " --json " + file("json"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json result = json();
  const Json &stand = result.at("rows")[0], &back = result.at("rows")[1];
  EXPECT_EQ(stand.at("name"), "stand");
  EXPECT_EQ(stand.at("gait"), "stand");
  EXPECT_EQ(stand.at("walks"), true) << "it stands and takes no step";
  EXPECT_EQ(stand.at("direction"), "forward");
  EXPECT_EQ(back.at("direction"), "backward");
  EXPECT_EQ(back.at("push_at"), "torso");
  EXPECT_EQ(back.at("plan_rate_hz"), 200.0);
  EXPECT_EQ(back.at("state"), "truth");
  EXPECT_GE(back.at("push_all_phases_N").get<double>(), 0.0) << "limits are positive";
  const auto job = Json::parse(text_of(std::filesystem::path(file("results")) / "back_phase0of2_seed1.json"));
  EXPECT_GE(job.at("trials")[1].at("force_N").get<double>(), 0.0);
}

TEST_F(ExperimentCommand, AFolderKnowsWhatItsResultsWereMadeWith) {
  const std::string common = "disturbance --quick --controller mpc-hzd --out " + file("results");
  const std::string job = " --job mpc-hzd_0.50s_phase0of2_seed1";
  ASSERT_EQ(run(common + job).status, 0) << text_of(file("err"));
  const auto kept = std::filesystem::path(file("results")) / "settings.json";
  const Json settings = Json::parse(text_of(kept));
  const std::string version = ProgramTest::run("--version").output;
  EXPECT_NE(version.find(settings.at("version").get<std::string>()), std::string::npos);
  EXPECT_NE(version.find("commit            " + settings.at("commit").get<std::string>() + "\n"),
            std::string::npos)
      << version;
  EXPECT_EQ(settings.at("configuration").at("mpc-hzd_0.50s").get<std::string>().size(), 16u);
  EXPECT_EQ(run(common + job).status, 0) << "the same again";

  // Another gait under the same options is another configuration.
  const auto gaits = std::filesystem::path(file("gaits"));
  std::filesystem::copy(SHIPPED_GAITS, gaits);
  const std::string with_gaits =
      "disturbance --quick --controller mpc-hzd --gaits " + gaits.string() + " --out " + file("others") + job;
  ASSERT_EQ(run(with_gaits).status, 0) << text_of(file("err"));
  std::ofstream(gaits / "amber3m_0.50.toml", std::ios::app) << "# a remark\n";
  const Outcome refused = run(with_gaits);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.errors.find("another configuration of mpc-hzd_0.50s"), std::string::npos)
      << refused.errors;

  for (const char* more :
       {" --set sqp.iterations=5", " --plant friction=0.5", " --push-at torso", " --direction backward",
        " --state truth", " --plan-rate 100", " --gait step", " --speed 0.4"}) {
    EXPECT_EQ(run(common + job + more).status, 2) << more;
  }

  Json older = settings;
  older["commit"] = "0123456789ab";
  std::ofstream(kept) << older;
  const Outcome other_commit = run(common + job);
  EXPECT_EQ(other_commit.status, 2);
  EXPECT_NE(other_commit.errors.find("another commit (0123456789ab there, "), std::string::npos)
      << other_commit.errors;
}

TEST_F(ExperimentCommand, HorizonFindsTheShortestOneThatWalks) {
  const Outcome outcome = run("horizon --quick --controller mpc-heuristic --controller mpc-hzd --out " +
                              file("results") + " --json " + file("json"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json result = json();
  EXPECT_EQ(result.at("rows")[0].at("shortest_horizon_s"), 0.2);
  EXPECT_EQ(result.at("rows")[1].at("shortest_horizon_s"), 0.2);
  for (const Json& tried : result.at("rows")[1].at("tried")) {
    EXPECT_EQ(tried.at("walks"), true);
    EXPECT_NEAR(tried.at("mean_speed_m_s").get<double>(), 0.5, 0.05);
  }
  EXPECT_TRUE(result.at("settings").contains("commit"));
}

TEST_F(ExperimentCommand, PairedComparesTheVariantsOnTheSamePushes) {
  const Outcome outcome =
      run("paired --quick --horizon 0.5 --out " + file("results") + " --json " + file("json"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json result = json();
  EXPECT_EQ(result.at("variants")[3].at("setting").at("plan_rate_hz"), 500.0);
  ASSERT_EQ(result.at("rows").size(), 4u);
  for (const Json& row : result.at("rows")) {
    for (const char* variant : {"rate_100_gains_off", "rate_100", "rate_200", "rate_500", "truth"}) {
      EXPECT_LE(row.at("survived").at(variant), 2) << row.at("push");
    }
  }
  EXPECT_EQ(result.at("rows")[0].at("survived").at("rate_200"), 2) << "175 N forward at the hip";
  EXPECT_EQ(result.at("comparisons")[4].at("from"), "rate_100_gains_off");
  EXPECT_EQ(result.at("comparisons")[4].at("to"), "rate_100");
  EXPECT_EQ(result.at("comparisons")[4].at("cases"), 8);
  EXPECT_TRUE(result.at("settings").contains("commit"));
}

TEST_F(ExperimentCommand, PairedTakesOtherPushes) {
  const std::string to = " --out " + file("results") + " --json " + file("json");
  const Outcome outcome = run("paired --quick --cases 1 --push torso:-300 --push hip:20" + to);
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json rows = json().at("rows");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("push"), "torso_-300N");
  EXPECT_EQ(rows[0].at("force_N"), -300.0);
  EXPECT_EQ(rows[0].at("point"), "torso");
  EXPECT_EQ(rows[1].at("push"), "hip_20N");
  for (const auto& [variant, survived] : rows[0].at("survived").items()) EXPECT_EQ(survived, 0) << variant;
  for (const auto& [variant, survived] : rows[1].at("survived").items()) EXPECT_EQ(survived, 1) << variant;
  for (const char* wrong : {"hip", "knee:20", "hip:", "hip:1001", "hip:nan", "hip:20N"}) {
    const Outcome refused = run(std::string("paired --push ").append(wrong) + to);
    EXPECT_EQ(refused.status, 2) << wrong;
    EXPECT_NE(refused.errors.find(std::string("--push ").append(wrong) + ": must be POINT:FORCE"),
              std::string::npos)
        << refused.errors;
  }
  const Outcome twice = run("paired --push hip:20 --push hip:20.0" + to);
  EXPECT_EQ(twice.status, 2);
  EXPECT_NE(twice.errors.find("--push hip:20.0: is given twice"), std::string::npos) << twice.errors;
}

TEST_F(ExperimentCommand, LimitsGivesTheFieldsOfItsContract) {
  const Outcome outcome =
      run("limits --quick --horizon 0.5 --quantity step_down --quantity friction --quantity commands --out " +
          file("results") + " --json " + file("json"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json result = json();
  ASSERT_EQ(result.at("rows").size(), 2u);
  const Json& step = result.at("rows")[0];
  EXPECT_EQ(step.at("quantity"), "ground step");
  EXPECT_EQ(step.at("unit"), "m");
  EXPECT_EQ(step.at("direction"), "down");
  EXPECT_LE(step.at("limit_all").get<double>(), -0.08);
  EXPECT_LE(result.at("rows")[1].at("limit_all").get<double>(), 0.4);
  for (const Json& row : result.at("rows")) {
    for (const char* field : {"limit_half", "cases", "falls", "coarse", "fine", "last_tried", "limits"}) {
      EXPECT_TRUE(row.contains(field)) << field;
    }
  }
  ASSERT_EQ(result.at("sequences").size(), 1u);
  EXPECT_EQ(result.at("sequences")[0].at("of"), 1);
  EXPECT_NE(outcome.output.find("random sequences of commands"), std::string::npos);
  EXPECT_EQ(result.at("command"),
            "stilt experiment limits --quick --horizon 0.5 --quantity step_down --quantity friction "
            "--quantity commands --out DIR");
}

TEST_F(ExperimentCommand, FiguresAreAPageAndTheNumbersOnIt) {
  const Outcome outcome = run("figures --quick --out " + file("results") + " --json " + file("json"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const std::string page = text_of(std::filesystem::path(file("results")) / "figures.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
  const Json numbers = json();
  EXPECT_EQ(numbers.at("push").at("survived"), true);
  EXPECT_NE(page.find("Touch-downs around a push of 130 N for 1 s"), std::string::npos);
  ASSERT_EQ(numbers.at("recovery").size(), 2u);
  for (const Json& push : numbers.at("recovery")) {
    EXPECT_EQ(push.at("survived"), true) << push;
    ASSERT_FALSE(push.at("recovery_steps").is_null()) << push;
    EXPECT_GE(push.at("steps").size(), 5u)
        << "one before the push of 1 s, three or four under it, one after it";
  }
  ASSERT_EQ(numbers.at("periodicity").size(), 3u);
  for (const Json& walk : numbers.at("periodicity")) {
    EXPECT_GE(walk.at("steps").get<int>(), 10);
    EXPECT_GT(walk.at("joint_angle_std_rms_rad").get<double>(), 0.0);
  }
}

TEST_F(ExperimentCommand, BadUsageIsOneSentenceAndStatusTwo) {
  std::ofstream(file("file")) << "no folder";
  const std::string out = std::string("disturbance --out ").append(file("new"));
  std::vector<std::string> mistakes = {"", "disturbance", "disturbance --out /proc/nowhere --merge"};
  mistakes.push_back(std::string("disturbance --merge --out ").append(file("file")));
  mistakes.push_back(std::string("horizon --horizon -1 --out ").append(file("new")));
  mistakes.push_back(std::string("figures --json /nowhere/x.json --out ").append(file("new")));
  mistakes.push_back(std::string("limits --quantity weather --out ").append(file("new")));
  mistakes.push_back(out + " --controller mpc-hzd --rows " PUBLISHED_ROWS "/rabbit.toml");
  for (const char* more :
       {" --phases 0", " --controller nonsense", " --controller nonsense --horizon 0.5",
        " --horizon 9 --controller mpc-hzd", " --plant gravity=1", " --push-at head", " --gait trot",
        " --direction up", " --state guessed", " --speed 9", " --plan-rate 0", " --rows /nowhere/rows.toml",
        " --job nonsense", " --set cost.nothing=1", " --preset nonsense"}) {
    mistakes.push_back(out + more);
  }
  for (const std::string& arguments : mistakes) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << ": " << outcome.errors;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1)
        << arguments << ": " << outcome.errors;
  }
}

}  // namespace
}  // namespace stilt::experiments
