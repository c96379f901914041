#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
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
}

TEST_F(ExperimentCommand, DisturbanceGivesTheFieldsOfItsContractAndGoesOnWhereItWas) {
  const std::string command = "disturbance --quick --controller mpc-heuristic --controller hzd-pd --out " +
                              file("results") + " --json " + file("json");
  ASSERT_EQ(run(command).status, 0) << text_of(file("err"));
  const Json first = json();
  ASSERT_EQ(first.at("rows").size(), 2u);
  for (const Json& row : first.at("rows")) {
    for (const char* field : {"controller", "horizon_s", "push_all_phases_N", "push_half_phases_N", "paper_N",
                              "step_length_range_m", "first_slip_N", "saturated_s"}) {
      EXPECT_TRUE(row.contains(field)) << field;
    }
  }
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
}

TEST_F(ExperimentCommand, HorizonFindsTheShortestOneThatWalks) {
  const Outcome outcome = run("horizon --quick --controller mpc-heuristic --controller mpc-hzd --out " +
                              file("results") + " --json " + file("json"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json result = json();
  EXPECT_EQ(result.at("rows")[0].at("shortest_horizon_s"), 0.5);
  EXPECT_EQ(result.at("rows")[1].at("shortest_horizon_s"), 0.2);
}

TEST_F(ExperimentCommand, FiguresAreAPageAndTheNumbersOnIt) {
  const Outcome outcome = run("figures --quick --out " + file("results") + " --json " + file("json"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const std::string page = text_of(std::filesystem::path(file("results")) / "figures.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
  const Json numbers = json();
  EXPECT_EQ(numbers.at("push").at("survived"), true);
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
  for (const char* more : {" --phases 0", " --controller nobody", " --controller nobody --horizon 0.5",
                           " --horizon 9 --controller mpc-hzd", " --plant gravity=1", " --push-at head",
                           " --job nobody", " --set cost.nothing=1"}) {
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
