#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <utility>

#include "tests/host_tools/program_test.h"
#include "tests/own_domain.h"

namespace stilt::cli {
namespace {

using Json = nlohmann::json;

using testing_support::Outcome;
using testing_support::text_of;

class CommandLine : public testing_support::ProgramTest {};

TEST_F(CommandLine, BadUsageIsOneSentenceAndStatusTwo) {
  for (const char* arguments : {"",
                                "--nope",
                                "dance",
                                "model",
                                "model eval --robot nonsense",
                                "sim --nope",
                                "sim --robot nonsense",
                                "sim --gait trot",
                                "sim --speed 9",
                                "sim --speed fast",
                                "sim --speed nan",
                                "sim --duration 0",
                                "sim --duration inf",
                                "sim --controller mpc-best",
                                "sim --controller nothing",
                                "sim --controller mpc-lumped --lump feet",
                                "sim --horizon 3",
                                "sim --horizon -1",
                                "sim --iterations 0",
                                "sim --plan-rate 0",
                                "sim --plan-delay -1",
                                "sim --push 40",
                                "sim --push 40@1+1 --push 40@1.5+1@torso",
                                "sim --then walk",
                                "sim --state guessed",
                                "sim --gains some",
                                "sim --seed -1",
                                "sim --seed 99999999999999999999",
                                "robot --bus loopback:none --seed 4294967296",
                                "sim --horizon nan",
                                "record --out /tmp/none.mcap --duration nan",
                                "experiment robustness --out /tmp/none --force nan",
                                "report /nowhere/a.html /nowhere/b.html --shift nan",
                                "sim --lump bad",
                                "sim --lump legs",
                                "bench --lump legs",
                                "sim --push 40@20+1 --duration 0.5",
                                "sim --then stand@10",
                                "sim --fault base-silent@12",
                                "help nope",
                                "help gait nope",
                                "sim --set cost.nothing=1",
                                "sim --set cost.base_x",
                                "sim --config /nowhere/amber3m.toml",
                                "sim --preset nonsense",
                                "bench --preset nonsense",
                                "robot --preset nonsense --bus loopback:none",
                                "sim --set reference.base_height_m=0.9",
                                "sim --set reference.base_height_m=0.1",
                                "sim --plant nothing=1",
                                "sim --plant friction=99",
                                "sim --json /nowhere/run.json",
                                "sim --report /nowhere/run.html",
                                "sim --log /nowhere/run.log",
                                "monitor --viewers app.foxglove.dev",
                                "monitor --viewers https://app.foxglove.dev/",
                                "monitor --interface nowhere0",
                                "record --out /tmp/none.mcap --duration 0.1 --peers 10.0.0.1,300.1.1.1",
                                "record --out /tmp/none.mcap --duration 0.1 --peers 'a\"b'",
                                "monitor --security-folder /nowhere",
                                "record --out /tmp/none.mcap --security-folder /nowhere",
                                "bench --problems 0",
                                "bench --horizon 9",
                                "bench --closed-loop -1",
                                "bench --speed 50"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_EQ(outcome.output, "") << arguments;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1)
        << arguments << outcome.errors;
    EXPECT_EQ(outcome.errors.rfind("stilt: ", 0), 0u) << arguments << outcome.errors;
  }
}

TEST_F(CommandLine, AMistakeIsSaidOfTheCommandItBelongsTo) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"record", "stilt: record: --out is required; see stilt record --help\n"},
      {"gait show x.toml", "stilt: gait show: --report is required; see stilt gait show --help\n"},
      {"gait check", "stilt: gait check: file is required; see stilt gait check --help\n"},
      {"log csv x.mcap", "stilt: log csv: --out is required; see stilt log csv --help\n"},
      {"experiment disturbance",
       "stilt: experiment disturbance: --out is required; see stilt experiment disturbance --help\n"},
      {"gait",
       "stilt: gait: a command is expected: synthesize, check, complete, library or show; see stilt gait "
       "--help\n"},
      {"gait chek x", "stilt: gait: chek is no command; did you mean check?; see stilt gait --help\n"},
      {"reccord", "stilt: reccord is no command; did you mean record?; see stilt --help\n"},
      {"sim 1 --sped", "stilt: sim: --sped is no option; did you mean --speed?; see stilt sim --help\n"},
      {"sim bench", "stilt: sim: bench is a second command; give one at a time; see stilt sim --help\n"},
      {"sim --json ''",
       "stilt: sim: --json: its value is empty; give one, or leave --json out; see stilt sim --help\n"},
      {"report ''",
       "stilt: report: FILE: its value is empty; give one, or leave FILE out; see stilt report --help\n"},
      {"sim --push 40@20+1 --duration 0.5",
       "stilt: --push at 20 s never begins: the run ends at 0.5 s; take a longer --duration\n"},
      {"sim --push 400@0.1004+0.0005",
       "stilt: --push: 0.0005 s are shorter than a tick, 0.001 s; a push begins and ends with a tick\n"},
      {"sim --plant step_height_m=0.1 --plant step_position_m=100",
       "stilt: --plant step_position_m=100: step_position_m must be a number from -99 to 99 m\n"},
      {"sim --plant ground_slope_rad=0.4",
       "stilt: --plant ground_slope_rad=0.4: no place to stand: a foot -0.15 m ahead of the hip and 0.863419 "
       "m "
       "below it is out of reach of a leg of 0.4064 m and 0.4667 m\n"},
      {"sim --plant ground_slope_rad=0.1 --plant step_height_m=-0.3 --plant step_position_m=0",
       "stilt: --plant ground_slope_rad=0.1, --plant step_height_m=-0.3: no place to stand: a foot 0.15 m "
       "ahead "
       "of the hip and 1.08495 m below it is out of reach of a leg of 0.4064 m and 0.4667 m\n"},
      {"sim --speed nan",
       "stilt: sim: --speed: nan is no number; give one, such as 0.5; see stilt sim --help\n"},
      {"sim --lump legs", "stilt: --lump legs: only --controller mpc-lumped neglects mass and inertia\n"},
      {"report x.mcap --shift 1", "stilt: --shift 1: needs a second file\n"},
      {"report x.mcap y.mcap --shift -2e6", "stilt: --shift -2e+06: must lie within 1000000 s either way\n"},
      {"replay x.mcap --port 9000", "stilt: replay: --port requires --monitor; see stilt replay --help\n"},
      {"replay x.mcap --no-browser",
       "stilt: replay: --no-browser requires --monitor; see stilt replay --help\n"},
      {"sim --controller mpc-hzd --robot rabbit",
       "stilt: --controller mpc-hzd: no gaits of rabbit are shipped; stilt gait library makes a folder of "
       "them\n"},
      {"sim --controller hzd-pd --set gait.single_support_s=0.5",
       "stilt: --controller hzd-pd: gait.single_support_s = 0.5 must be the step time of the gaits that "
       "plans "
       "follow, 0.3; stilt gait library --step-time 0.5 makes others, for stilt sim --gaits\n"},
      {"help nope", "stilt: help: nope is no command; see stilt --help\n"},
      {"help gait nope", "stilt: help: gait nope is no command; see stilt --help\n"},
      {"sim 1", "stilt: sim: 1 is not expected; see stilt sim --help\n"},
      {"bench --controller hzd-pd",
       "stilt: --controller hzd-pd: it tracks gaits without planning; choose one that plans\n"},
  };
  for (const auto& [arguments, sentence] : mistakes) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_EQ(outcome.errors, sentence) << arguments;
  }
  EXPECT_NE(run("dance").errors.find("dance is no command; there are sim, bench, robot"), std::string::npos)
      << run("dance").errors;
}

TEST_F(CommandLine, ARobotBesideARecordThatNamesItsOwnIsRefused) {
  std::ofstream(file("walk.mcap")) << "\x89MCAP0\r\n";
  std::ofstream(file("ticks.csv")) << "tick,";
  const std::string sentence =
      "stilt: --robot rabbit: needs samples or a black box; a record and a report name their robot\n";
  EXPECT_EQ(run("report " + file("walk.mcap") + " --robot rabbit").errors, sentence);
  EXPECT_NE(run("report " + file("walk.mcap") + ' ' + file("ticks.csv") + " --robot rabbit").errors,
            sentence);
}

TEST_F(CommandLine, EveryCommandShowsExamplesOfItself) {
  for (const std::string command : {"",
                                    "sim",
                                    "robot",
                                    "gait",
                                    "gait synthesize",
                                    "gait check",
                                    "gait complete",
                                    "gait library",
                                    "gait show",
                                    "experiment",
                                    "experiment frequency",
                                    "experiment disturbance",
                                    "experiment horizon",
                                    "experiment limits",
                                    "experiment robustness",
                                    "experiment paired",
                                    "experiment figures",
                                    "monitor",
                                    "bench",
                                    "record",
                                    "replay",
                                    "log",
                                    "log csv",
                                    "report",
                                    "config",
                                    "config migrate",
                                    "model",
                                    "model eval"}) {
    const Outcome outcome = run(command + " --help");
    EXPECT_EQ(outcome.status, 0) << command;
    EXPECT_NE(outcome.output.find("Examples:\n  stilt " + command), std::string::npos) << command;
    EXPECT_EQ(run("help " + command).output, outcome.output) << command;
  }
  EXPECT_EQ(run("version").output, run("--version").output);
  EXPECT_EQ(run("-v").output, run("--version").output);
}

TEST_F(CommandLine, HelpShowsTheShippedHorizonIterationsAndPlanRate) {
  const std::string help = run("sim --help").output;
  // As CLI11 of Debian 12 and that of Debian 13 have it.
  const std::pair<const char*, const char*> options[] = {
      {"--horizon FLOAT=1 ", "--horizon FLOAT [1] "},
      {"--iterations INT=10 ", "--iterations INT [10] "},
      {"--plan-rate FLOAT=500 ", "--plan-rate FLOAT [500] "}};
  for (const auto& [twelve, thirteen] : options) {
    EXPECT_TRUE(help.contains(twelve) || help.contains(thirteen)) << twelve << '\n' << help;
  }
}

TEST_F(CommandLine, AFullDiskIsSaidWithItsReasonAndWhatWasPrintedStays) {
  for (const char* option : {"--json", "--report", "--log"}) {
    const Outcome outcome = run(std::string("sim --gait stand --duration 0.5 ") + option + " /dev/full");
    EXPECT_EQ(outcome.status, 2) << option;
    EXPECT_NE(outcome.errors.find("No space left on device"), std::string::npos) << option << outcome.errors;
    EXPECT_NE(outcome.errors.find(std::string(option) + " /dev/full"), std::string::npos) << outcome.errors;
    EXPECT_NE(outcome.output.find("on its feet after 0.5 s"), std::string::npos) << option;
  }
  const Outcome others = run("sim --gait stand --duration 0.5 --json /dev/full --log " + file("a.jsonl") +
                             " --report " + file("a.html"));
  EXPECT_EQ(others.status, 2);
  for (const char* name : {"a.jsonl", "a.html"}) EXPECT_NE(text_of(file(name)), "") << name << others.errors;
  const std::string gait = SHIPPED_GAITS "/amber3m_0.50.toml";
  EXPECT_NE(run("gait show " + gait + " --report /dev/full")
                .errors.find("--report /dev/full: the file cannot be "
                             "written (No space left on device)"),
            std::string::npos);
  for (const char* arguments :
       {"sim --gait stand --duration 0.5 --json -", "sim --gait stand --duration 0.5", "help"}) {
    for (const char* output : {" >/dev/full 2>/dev/null", " <&- >&- 2>&-"}) {
      EXPECT_EQ(std::system((std::string(STILT_PROGRAM) + " " + arguments + output).c_str()) >> 8, 2)
          << arguments << output;
    }
  }
}

TEST_F(CommandLine, AFileThatWasWrittenIsNamed) {
  const Outcome outcome = run("sim --gait stand --duration 0.5 --json " + file("a.json") + " --report " +
                              file("a.html") + " --log " + file("a.jsonl"));
  for (const char* name : {"a.json", "a.html", "a.jsonl"}) {
    EXPECT_NE(outcome.errors.find("written: " + file(name) + "\n"), std::string::npos) << outcome.errors;
  }
}

TEST_F(CommandLine, APageOfAReplayHasNoResults) {
  const Outcome outcome = run("replay walk.mcap --monitor --json -");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.errors.find("--json -: a page has no results; leave --json or --monitor out"),
            std::string::npos)
      << outcome.errors;
}

TEST_F(CommandLine, AFolderWhereAFileBelongsIsRefusedWithItsName) {
  const std::string folder = file("d.urdf");
  std::filesystem::create_directory(folder);
  const std::string rows = "experiment disturbance --out " + file("out") + " --rows ";
  for (const std::string& command : {std::string("gait check "), std::string("sim --robot "),
                                     std::string("config migrate "), std::string("report "), rows}) {
    const Outcome outcome = run(command + folder);
    EXPECT_EQ(outcome.status, 2) << command;
    EXPECT_NE(outcome.errors.find(folder + ": "), std::string::npos) << command << outcome.errors;
    EXPECT_EQ(outcome.errors.find("basic_filebuf"), std::string::npos) << command << outcome.errors;
  }
}

TEST_F(CommandLine, AFileThatIsNoGaitIsCalledSo) {
  std::ofstream(file("a.toml")) << "a = 1\n";
  EXPECT_NE(run("gait check " + file("a.toml")).errors.find("a.toml: is no gait file"), std::string::npos);
}

TEST_F(CommandLine, ARobotWithAHipOffsetIsRefusedByEveryCommandThatTakesARobot) {
  const std::string robot = " --robot " STILT_TEST_DATA "/robots/hip_offset.urdf";
  for (const std::string command :
       {"sim", "bench", "model eval", "gait synthesize --speed 0.5 --out /dev/null",
        "robot --bus loopback:none"}) {
    const Outcome outcome = run(command + robot);
    EXPECT_EQ(outcome.status, 2) << command;
    EXPECT_NE(outcome.errors.find(
                  "hip_offset.urdf: joint 'hip_L' stands at x 0.03 m, z 0 m of link 'torso'; both hips "
                  "must stand at its origin"),
              std::string::npos)
        << command << ": " << outcome.errors;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << command << outcome.errors;
  }
}

TEST_F(CommandLine, HelpAndVersionGoToStandardOutput) {
  for (const char* arguments :
       {"--help", "sim --help", "bench --help", "model --help", "model eval --help"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 0) << arguments;
    EXPECT_NE(outcome.output, "") << arguments;
  }
  const Outcome version = run("--version");
  EXPECT_EQ(version.status, 0);
  EXPECT_TRUE(std::regex_search(version.output, std::regex("\ncontroller object [0-9]+\\.[0-9]{2} MB\n")))
      << version.output;
  EXPECT_TRUE(std::regex_search(version.output,
                                std::regex("\ncommit +([0-9a-f]{12,}(-dirty[.][0-9TZ]+)?|unknown)\n")))
      << version.output;
}

TEST_F(CommandLine, AMonitorInTextNeedsATerminal) {
  const Outcome outcome = run("monitor --terminal --domain " + std::to_string(tests::own_domain()));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.errors.find("standard output is no terminal that can be drawn on"), std::string::npos)
      << outcome.errors;
  EXPECT_EQ(outcome.output, "");
}

TEST_F(CommandLine, ABenchmarkGivesEveryFigureOfItsContract) {
  const Outcome outcome = run("bench --problems 30 --horizon 0.5 --iterations 3 --no-early-stop --json -");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json json = Json::parse(outcome.output);
  for (const char* field : {"nodes", "solve_us", "rate_hz", "phases_us", "iterations", "isa", "threads"}) {
    EXPECT_TRUE(json.contains(field)) << field;
  }
  for (const char* phase : {"linearise", "riccati", "line_search", "other"}) {
    EXPECT_GT(json["phases_us"][phase].get<double>(), 0.0) << phase;
  }
  EXPECT_GE(json["nodes"].get<int>(), 34);
  EXPECT_LE(json["iterations"]["max"].get<int>(), 3);
  EXPECT_GT(json["kernels"]["peak_gflop_s"].get<double>(), 0.0);
  for (const char* kernel : {"linearise", "riccati", "line_search_trial"}) {
    EXPECT_GT(json["kernels"][kernel]["time_us"].get<double>(), 0.0) << kernel;
  }
}

TEST_F(CommandLine, ABenchmarkInClosedLoopComparesTheLongestPlansWithTheMedian) {
  const Outcome outcome = run("bench --closed-loop 40 --horizon 0.3 --iterations 4 --json -");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json json = Json::parse(outcome.output);
  EXPECT_GE(json["plans"].get<int>(), 40);
  EXPECT_GE(json["solve_us"]["p999_over_p50"].get<double>(), 1.0);
  ASSERT_FALSE(json["worst"].empty());
  EXPECT_EQ(json["worst"].front()["iterations"].get<int>(), 4) << "all iterations are used";
}

TEST_F(CommandLine, ModelEvaluationReadsLinesAndRefusesTheFirstBadOne) {
  const std::string good = R"({"x": [0,0.8,0,0,0,0,0,0,0,0,0,0,0,0], "u": [0,0,0,0,0,100,0,100]})";
  const Outcome right = run("model eval --robot amber3m", good + "\n" + good + "\n");
  EXPECT_EQ(right.status, 0) << right.errors;
  EXPECT_EQ(std::count(right.output.begin(), right.output.end(), '\n'), 2);
  const Outcome wrong = run("model eval", good + "\nnonsense\n");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.errors.find("line 2"), std::string::npos) << wrong.errors;
  EXPECT_EQ(std::system(STILT_PROGRAM " model eval </tmp 2>/dev/null") >> 8, 2) << "a folder";
}

}  // namespace
}  // namespace stilt::cli
