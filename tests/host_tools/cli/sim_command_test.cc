#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <utility>

#include "host_tools/web/report/comparison_page.h"
#include "tests/host_tools/program_test.h"

namespace stilt::cli {
namespace {

using Json = nlohmann::json;

using testing_support::Outcome;
using testing_support::text_of;

class SimCommand : public testing_support::ProgramTest {};

TEST_F(SimCommand, GainsAreThoseOfTheConfigurationKey) {
  const auto distance = [&](const std::string& option) {
    const Outcome outcome = run("sim --duration 2 --push 60@0.5+1 --plan-delay 0.01 --json - " + option);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    return nlohmann::json::parse(outcome.output).at("distance_m").get<double>();
  };
  EXPECT_EQ(distance("--gains on"), distance("--set torque_law.use_feedback_gains=true"));
  EXPECT_EQ(distance("--gains on"), distance(""));
  EXPECT_NE(distance("--gains off"), distance("")) << "plans are 10 to 15 ms old";
}

/// Ticks of 1 ms: 300 Hz are 3.33 ms, and 4.6 ms are as long as 5.
TEST_F(SimCommand, TheTimingOfPlansThatIsInEffectIsReported) {
  const auto timing = [&](const std::string& options) {
    const Outcome outcome = run("sim --gait stand --duration 0.1 " + options + " --json " + file("run.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    const Json json = Json::parse(text_of(file("run.json")));
    const std::size_t line = outcome.output.find("\nplans  ");
    EXPECT_NE(line, std::string::npos) << outcome.output;
    const std::size_t text = outcome.output.find("one every", line);
    return std::tuple(json.at("plan_period_s").get<double>(), json.at("plan_delay_s").get<double>(),
                      outcome.output.substr(text, outcome.output.find('\n', text) - text));
  };
  EXPECT_EQ(timing(""), std::tuple(0.002, 0.002, "one every 2 ms, in use 2 ms after its state"));
  EXPECT_EQ(timing("--plan-rate 300 --plan-delay 0.0024"),
            std::tuple(0.003, 0.002, "one every 3 ms, in use 2 ms after its state"));
  EXPECT_EQ(timing("--plan-rate 1000 --plan-delay 0.0046"),
            std::tuple(0.005, 0.005, "one every 5 ms, in use 5 ms after its state"));
  EXPECT_EQ(timing("--plan-delay 0"),
            std::tuple(0.002, 0.001, "one every 2 ms, in use 1 ms after its state"));
}

TEST_F(SimCommand, TheRobotIsThatOfTheConfigurationUnlessItIsNamed) {
  const std::string file_name = file("robot.toml");
  std::ofstream(file_name) << "[hardware]\nrobot = \"rabbit\"\n[reference]\nbase_height_m = 0.73\n";
  const auto log_of = [&](const std::string& options) {
    const Outcome outcome = run("sim --gait stand --duration 0.2 --log - " + options);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    return outcome.output;
  };
  EXPECT_EQ(log_of("--config " + file_name), log_of("--config " + file_name + " --robot rabbit"));
  EXPECT_NE(log_of("--config " + file_name), log_of("--config " + file_name + " --robot amber3m"));
  const Outcome outcome = run("sim --set hardware.robot=rabbit");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.errors,
            "stilt: hardware.robot: rabbit is another robot than amber3m; take --robot rabbit\n");
}

TEST_F(SimCommand, ASimulationGivesEveryFigureOfItsContract) {
  const Outcome outcome = run("sim --gait walk --speed 0.5 --duration 4 --json -");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json json = Json::parse(outcome.output);
  for (const char* field :
       {"survived", "fall_time_s", "fall_margin_min", "duration_s", "distance_m", "mean_speed_m_s", "steps",
        "step_length_min_m", "step_length_max_m", "peak_torque_Nm", "peak_joint_speed_rad_s",
        "slip_distance_m", "solve_time_us", "sqp_iterations", "dynamics_defect_max", "equality_violation_max",
        "heap_allocations_in_loop", "controller_bytes"}) {
    EXPECT_TRUE(json.contains(field)) << field;
  }
  EXPECT_EQ(json["survived"], true);
  EXPECT_TRUE(json["fall_time_s"].is_null());
  EXPECT_EQ(json["heap_allocations_in_loop"], 0);
  EXPECT_EQ(json["peak_torque_Nm"].size(), 4u);
  ASSERT_FALSE(json["steps"].empty());
  for (const char* field : {"time_s", "foot", "length_m"})
    EXPECT_TRUE(json["steps"][0].contains(field)) << field;
  for (const char* field : {"p50", "p99", "max"}) EXPECT_TRUE(json["solve_time_us"].contains(field)) << field;
  for (const char* level : {"plan", "plan_feedback", "gait", "hold", "sit", "tuck", "damp", "off"}) {
    EXPECT_TRUE(json["fallback_s"].contains(level)) << level;
  }
  EXPECT_EQ(json["fallback_s"]["tuck"], 0.0) << "a falling robot is damped";
  for (const char* field :
       {"defect_max", "equality_violation_max", "cone_violation_max_N", "normal_force_min_N"}) {
    EXPECT_TRUE(json["plan_in_use"].contains(field)) << field;
  }
}

/// The signal of Ctrl-C.
TEST_F(SimCommand, AnInterruptedRunLeavesItsResults) {
  const std::string name = "results_caf\xe9.json";
  const int status =
      std::system(("timeout -k 60 -s INT 2 " STILT_PROGRAM " sim --duration 86400 --json '" + file(name) +
                   "' --report " + file("run.html") + " >" + file("out") + " 2>" + file("err"))
                      .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 124) << "of timeout";
  const auto json = nlohmann::json::parse(text_of(file(name)));
  EXPECT_GT(json.at("duration_s").get<double>(), 0.0);
  EXPECT_LT(json.at("duration_s").get<double>(), 86400.0);
  EXPECT_NE(text_of(file("err")).find("interrupted: the results are of the first "), std::string::npos);
  EXPECT_NE(text_of(file("run.html")).find("<svg"), std::string::npos);
}

TEST_F(SimCommand, AFallIsStatusOneAndSaidInWordsAndFigures) {
  const Outcome outcome = run("sim --duration 5 --push 400@1+1 --json " + file("run.json"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.output.find("FELL"), std::string::npos);
  const Json json = Json::parse(text_of(file("run.json")));
  EXPECT_EQ(json["survived"], false);
  EXPECT_GT(json["fall_time_s"].get<double>(), 1.0);
}

TEST_F(SimCommand, ARunLeavesReportAndLog) {
  const Outcome outcome =
      run("sim --gait stand --duration 0.5 --report " + file("run.html") + " --log " + file("run.jsonl"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_NE(text_of(file("run.html")).find("<html"), std::string::npos);
  const std::string log = text_of(file("run.jsonl"));
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 100);
  EXPECT_EQ(Json::parse(log.substr(0, log.find('\n')))["true_state"].size(), 14u);
}

TEST_F(SimCommand, ALogIsReportedWithTheSpeedAndThePushOfItsRun) {
  ASSERT_EQ(
      run("sim --duration 4 --push 20@3.2+0.5@torso --report " + file("a.html") + " --log " + file("b.jsonl"))
          .status,
      0);
  ASSERT_EQ(run("report " + file("b.jsonl") + " --out " + file("b.html")).status, 0);
  const Json direct = Json::parse(report::data_of_page(text_of(file("a.html"))));
  const Json logged = Json::parse(report::data_of_page(text_of(file("b.html"))));
  const auto speed = [](const Json& data) { return data["summary"]["mean_speed_m_s"].get<double>(); };
  const double sample_m = 0.005 * 1.0;  // the log ends up to a sample before the run
  EXPECT_NEAR(speed(logged), speed(direct), sample_m);
  const Json &one = direct["ticks"], &other = logged["ticks"];
  EXPECT_EQ(one["rows"], other["rows"]);
  EXPECT_EQ(one["float32_base64"], other["float32_base64"]) << "with the height of the push";
}

TEST_F(SimCommand, AReportHasTheLeastOfTheTorqueLimitsOfConfigurationAndMotors) {
  const auto limit_Nm = [&](const std::string& options) {
    EXPECT_EQ(run("sim --gait stand --duration 0.1 --report " + file("a.html") + options).status, 0);
    const Json data = Json::parse(report::data_of_page(text_of(file("a.html"))));
    return data["allowed_torque_Nm"].at(0).at(1).get<double>();
  };
  EXPECT_EQ(limit_Nm(" --set supervisor.torque_limit_share=0.75"), 60.0);
  EXPECT_EQ(limit_Nm(" --set supervisor.torque_limit_share=0.75 --plant torque_limit_Nm=70"), 60.0);
  EXPECT_EQ(limit_Nm(" --set supervisor.torque_limit_share=0.75 --plant torque_limit_Nm=50"), 50.0);
}

TEST_F(SimCommand, ALogOnStandardOutputStandsThereAlone) {
  const Outcome outcome = run("sim --gait stand --duration 0.05 --log -");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 10);
  EXPECT_TRUE(outcome.output.starts_with(R"({"time_s":0.0,)")) << outcome.output;
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST_F(SimCommand, AShortRunSaysNothingOfItsFirstThreeSeconds) {
  EXPECT_EQ(run("sim --gait stand --duration 0.5").output.find("first 3 s"), std::string::npos);
}

/// The robot turns before the step's end and comes back.
TEST_F(SimCommand, TheGroundIsDrawnWhereTheRobotWent) {
  ASSERT_EQ(run("sim --speed 0.8 --then walk:-0.8@5 --duration 12 --plant step_height_m=-0.01 --plant "
                "step_position_m=6 --report " +
                file("a.html"))
                .status,
            0);
  const Json data = Json::parse(report::data_of_page(text_of(file("a.html"))));
  EXPECT_EQ(data["ground"]["x_m"].size(), 4u) << data["ground"];
}

TEST_F(SimCommand, ALaterWalkWithoutASpeedHasTheOneOfTheFirst) {
  const auto distance_m = [&](const std::string& later) {
    const Outcome outcome = run("sim --gait stand --speed 0.4 --duration 4 --json - --then " + later);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    return Json::parse(outcome.output).at("distance_m").get<double>();
  };
  EXPECT_EQ(distance_m("walk@0.5"), distance_m("walk:0.4@0.5"));
}

TEST_F(SimCommand, TwoRunsBecomeAPageAndMistakesAreNamed) {
  ASSERT_EQ(run("sim --gait stand --duration 0.5 --report " + file("a.html")).status, 0);
  ASSERT_EQ(
      run("sim --gait stand --duration 0.5 --set gait.swing_height_m=0.08 --log " + file("b.jsonl")).status,
      0);
  const std::string page = text_of(file("a.html"));
  EXPECT_NE(page.find(R"("gait.swing_height_m":"0.07")"), std::string::npos) << "a report names its settings";
  EXPECT_NE(page.find(R"("settings":{"robot":"amber3m",)"), std::string::npos) << "as a record does";
  EXPECT_NE(page.find(R"("allowed_torque_Nm":[[80.0,80.0,80.0,80.0]])"), std::string::npos);
  const std::string both = "report " + file("a.html") + " " + file("b.jsonl");
  EXPECT_EQ(run(both + " --shift 0.5").status, 0);
  EXPECT_NE(text_of(file("a_b.html")).find(R"("shift_s": 0.5)"), std::string::npos)
      << "beside the first file";
  EXPECT_EQ(run("report " + file("b.jsonl")).status, 0);
  EXPECT_TRUE(std::filesystem::exists(file("b.html")));
  std::filesystem::resize_file(file("b.jsonl"), std::filesystem::file_size(file("b.jsonl")) - 20);
  const Outcome cut = run("report " + file("b.jsonl") + " --out " + file("b.html"));
  EXPECT_EQ(cut.status, 1);
  EXPECT_NE(cut.errors.find("is no sample of --log; the report ends before it"), std::string::npos);
  const auto complaint = [&](const std::string& arguments) {
    const Outcome outcome = run("report " + arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    return outcome.errors;
  };
  EXPECT_NE(complaint(file("a.html") + " --out " + file("c.html")).find("is a report already"),
            std::string::npos);
  EXPECT_NE(complaint(file("b.jsonl") + " --out " + file("b.jsonl")).find("is a file to be read"),
            std::string::npos);
  EXPECT_NE(complaint(file("a.html") + " " + file("a_b.html")).find("is no report of one run"),
            std::string::npos);
  EXPECT_NE(complaint("/nowhere/walk.mcap --out " + file("c.html")).find("No such file"), std::string::npos);
  std::ofstream(file("notes.txt")) << "walked well";
  EXPECT_NE(complaint(file("notes.txt")).find("is no file of a run"), std::string::npos);
}

/// `stilt sim --report walk.html` beside walk.mcap of stilt record.
TEST_F(SimCommand, AReportWithoutANameReplacesNoPage) {
  ASSERT_EQ(run("sim --gait stand --duration 0.2 --log " + file("walk.jsonl")).status, 0);
  std::ofstream(file("walk.html")) << "of a simulation";
  std::ofstream(file("walk_walk.html")) << "of two";
  for (const auto& [files, page] :
       {std::pair{" " + file("walk.jsonl"), "walk.html"},
        {" " + file("walk.jsonl") + " " + file("walk.jsonl"), "walk_walk.html"}}) {
    const std::string before = text_of(file(page));
    const Outcome refused = run("report" + files);
    EXPECT_EQ(refused.status, 2);
    EXPECT_EQ(refused.errors, "stilt: " + file(page) + ": exists; name another with --out\n");
    EXPECT_EQ(text_of(file(page)), before);
    EXPECT_EQ(run("report" + files + " --out " + file(page)).status, 0) << "a page that is named is replaced";
    EXPECT_NE(text_of(file(page)), before);
  }
}

TEST_F(SimCommand, APresetChangesTheRunAndWhatTheUserSetsChangesThePreset) {
  const std::string walk = "sim --duration 3 --json - ";
  const auto steps = [&](const std::string& options) {
    const Outcome outcome = run(walk + options);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    return Json::parse(outcome.output).at("steps");
  };
  const Json paper = steps("--preset paper");
  EXPECT_NE(paper, steps("--set discretisation.transition=identity --set gait.single_support_s=0.4"))
      << "it has more keys";
  EXPECT_EQ(paper,
            steps("--preset paper --set discretisation.transition=identity --set gait.single_support_s=0.4"));
  EXPECT_LT(paper.size(), steps("--preset paper --set gait.single_support_s=0.3").size());
}

TEST_F(SimCommand, ANegativeSpeedAndABackwardPushAreUnderstood) {
  const Outcome outcome = run("sim --speed -0.3 --push -10@1+0.5 --duration 4 --json -");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_LT(Json::parse(outcome.output)["distance_m"].get<double>(), -0.3);
}

TEST_F(SimCommand, CommandsMayFollowEachOther) {
  const Outcome outcome =
      run("sim --gait stand --then step@1 --then walk:0.4@3 --then stand@6 --duration 10 --json -");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json json = Json::parse(outcome.output);
  ASSERT_GT(json["steps"].size(), 5u);
  EXPECT_GT(json["steps"].front()["time_s"].get<double>(), 1.0);
  EXPECT_LT(json["steps"].back()["time_s"].get<double>(), 9.0);
}

}  // namespace
}  // namespace stilt::cli
