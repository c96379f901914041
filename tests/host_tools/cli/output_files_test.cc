// Where the files that commands write may be.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/host_tools/program_test.h"
#include "tests/own_domain.h"

namespace stilt::cli {
namespace {

using testing_support::Outcome;
using testing_support::text_of;

class CommandOutput : public testing_support::ProgramTest {
 protected:
  CommandOutput() {
    std::filesystem::copy_file(SHIPPED_GAITS "/amber3m_0.50.toml", file("in.toml"));
    std::filesystem::copy_file(file("in.toml"), file("in.csv"));
    std::filesystem::create_symlink("in.toml", file("link.toml"));
    std::ofstream(file("in.urdf")) << "<robot/>";
  }

  /// @param arguments  with @ for the test's folder
  Outcome run_here(std::string arguments) const {
    const std::string folder = file("");
    for (auto at = arguments.find('@'); at != std::string::npos; at = arguments.find('@')) {
      arguments.replace(at, 1, folder);
    }
    return run(arguments);
  }
};

TEST_F(CommandOutput, NoneIsAFileThatTheCommandReads) {
  const std::string text = text_of(file("in.toml"));
  for (const char* arguments :
       {"replay @in.toml --json @in.toml", "report @in.toml --out @in.toml", "log csv @in.csv --out @in.csv",
        "gait check @in.toml --json @in.toml", "gait check @in.toml --json @link.toml",
        "gait check @link.toml --json @in.toml", "gait complete @in.toml --out @./in.toml",
        "gait show @in.toml --report @in.toml", "gait synthesize --speed 0.5 --robot @in.urdf --out @in.urdf",
        "sim --config @in.toml --json @in.toml", "sim --robot @in.urdf --log @in.toml",
        "sim --robot @in.urdf --report @in.urdf", "bench --config @in.toml --json @in.toml",
        "robot --config @in.toml --frames @in.toml", "robot --hang --hands @in.toml --json @in.toml",
        "experiment horizon --out @jobs --config @in.toml --json @in.toml",
        "experiment disturbance --out @jobs --rows @in.toml --json @in.toml"}) {
    const Outcome outcome = run_here(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_NE(outcome.errors.find(": is a file to be read; name another one\n"), std::string::npos)
        << arguments << outcome.errors;
  }
  for (const char* name : {"in.toml", "in.csv"}) EXPECT_EQ(text_of(file(name)), text) << name;
  EXPECT_EQ(text_of(file("in.urdf")), "<robot/>");
}

TEST_F(CommandOutput, NoneIsAFileOfTheRobotOrAGaitThatTheCommandReads) {
  std::filesystem::create_directory(file("gl"));
  std::filesystem::copy_file(file("in.toml"), file("gl/one.toml"));
  std::filesystem::copy_file(STILT_TEST_DATA "/robots/heavy.urdf", file("own.urdf"));
  std::ofstream(file("wiring.toml")) << "[hardware]\nrobot = \"own.urdf\"\n";
  const std::string urdf = text_of(file("own.urdf")), gait = text_of(file("in.toml"));
  std::string of_own = gait;
  of_own.replace(of_own.find("\"amber3m\""), 9, "\"own.urdf\"");
  std::ofstream(file("own_gait.toml")) << of_own;
  std::ofstream(file("rows.toml")) << "[[row]]\nname = \"a\"\nrobot = \"" << file("own.urdf") << "\"\n";
  std::ofstream(file("gait_rows.toml"))
      << "[[row]]\nname = \"a\"\ncontroller = \"mpc-hzd\"\ngaits = \"" << file("gl") << "\"\n";
  for (const char* arguments :
       {"experiment disturbance --out @jobs --rows @rows.toml --json @own.urdf",
        "experiment disturbance --out @jobs --rows @gait_rows.toml --json @gl/one.toml",
        "report @in.csv --robot @own.urdf --out @own.urdf", "gait check @own_gait.toml --json @own.urdf",
        "gait show @own_gait.toml --report @own.urdf", "gait complete @own_gait.toml --out @own.urdf",
        "gait synthesize --speed 0.5 --robot @own.urdf --out @own.toml",
        "sim --controller mpc-hzd --gaits @gl --json @gl/one.toml",
        "bench --controller mpc-hzd --gaits @gl --json @gl/one.toml",
        "robot --config @wiring.toml --json @own.urdf", "sim --config @wiring.toml --json @own.urdf"}) {
    const Outcome outcome = run_here(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_NE(outcome.errors.find(": is a file to be read; name another one\n"), std::string::npos)
        << arguments << outcome.errors;
  }
  EXPECT_EQ(text_of(file("own.urdf")), urdf);
  EXPECT_EQ(text_of(file("gl/one.toml")), gait);
}

TEST_F(CommandOutput, EachHasItsOwnPlace) {
  for (const char* arguments :
       {"record --out @one --json @one", "sim --json @one --report @one", "sim --json @one --log @./one",
        "gait show @in.toml --report @one --json @one", "robot --log @one --frames @one",
        "gait synthesize --speed 0.5 --out @one --json @one"}) {
    const Outcome outcome = run_here(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_NE(outcome.errors.find("/one: is the file of --"), std::string::npos)
        << arguments << outcome.errors;
    EXPECT_FALSE(std::filesystem::exists(file("one"))) << arguments;
  }
  EXPECT_EQ(run_here("sim --gait stand --duration 0.01 --json /dev/null --log /dev/null").status, 0)
      << "a device stands for several";
}

TEST_F(CommandOutput, StandardOutputTakesOneAlone) {
  for (const char* arguments :
       {"sim --json - --log -", "robot --log - --frames -", "gait show @in.toml --report - --json",
        "gait complete @in.toml --out - --json"}) {
    const Outcome outcome = run_here(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_NE(outcome.errors.find(" -: standard output is taken by --"), std::string::npos)
        << arguments << outcome.errors;
    EXPECT_EQ(outcome.output, "") << arguments;
  }
  const Outcome completed = run_here("gait complete @in.toml --out -");
  EXPECT_EQ(completed.status, 0) << completed.errors;
  EXPECT_EQ(completed.output.find("valid\n"), std::string::npos) << "a gait file alone";
  for (const char* option : {"--log", "--frames"}) {
    const std::string name = "loopback:output_files_" + std::to_string(getpid());
    const std::string command = "timeout -s INT 1 " STILT_PROGRAM " robot --lockstep --bus " + name +
                                "_l --bus " + name + "_r " + option + " - >" + file("out") + " 2>" +
                                file("err");
    static_cast<void>(std::system(command.c_str()));
    EXPECT_NE(text_of(file("err")).find("ready for a controller"), std::string::npos) << text_of(file("err"));
    EXPECT_EQ(text_of(file("out")), "") << option << ": without a controller there are no samples and frames";
  }
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST_F(CommandOutput, AFolderIsNotStandardOutput) {
  for (const char* arguments :
       {"log csv @in.toml --out -", "gait library --out -", "experiment horizon --out -", "record --out -"}) {
    const Outcome outcome = run_here(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_NE(outcome.errors.find("--out -: "), std::string::npos) << arguments << outcome.errors;
  }
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST_F(CommandOutput, APlaceThatCannotBeIsRefusedBeforeTheWork) {
  for (const char* folder : {"horizon/table.md", "frequency/table.md", "figures/figures.html"}) {
    std::filesystem::create_directories(file(folder));
  }
  for (const std::string& arguments : {std::string("sim --duration 80000 --json @in.toml/run.json"),
                                       "sim --duration 80000 --log @" + std::string(256, 'a'),
                                       std::string("experiment horizon --out @horizon"),
                                       std::string("experiment frequency --out @frequency"),
                                       std::string("experiment figures --out @figures")}) {
    const Outcome outcome = run_here(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_NE(outcome.errors.find(": the file cannot be written ("), std::string::npos)
        << arguments << outcome.errors;
  }
}

/// A command that records nothing, in a domain without robots.
std::string record_in_own_domain() {
  return "record --duration 0.3 --domain " + std::to_string(tests::own_domain()) + " ";
}

TEST_F(CommandOutput, AnEarlierRecordStaysAndIsRefusedBeforeTheNetworkIsJoined) {
  std::ofstream(file("walk.mcap")) << "an earlier record";
  const Outcome outcome = run("record --out " + file("walk.mcap") + " --interface etth0");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.errors, "stilt: " + file("walk.mcap") + ": exists; name another file or remove it\n");
  EXPECT_EQ(text_of(file("walk.mcap")), "an earlier record");
}

TEST_F(CommandOutput, ARecordThatCannotBeginLeavesNoFile) {
  const Outcome outcome = run("record --out " + file("walk.mcap") + " --interface etth0");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
  EXPECT_FALSE(std::filesystem::exists(file("walk.mcap")));
}

TEST_F(CommandOutput, ARecordWithoutSpaceIsAccountedFor) {
  const std::string command = "trap '' XFSZ; ulimit -f 4; " STILT_PROGRAM " " + record_in_own_domain() +
                              "--out " + file("walk.mcap") + " --json " + file("run.json") + " >" +
                              file("out") + " 2>" + file("err");
  EXPECT_EQ(std::system(command.c_str()) >> 8, 2);
  const std::string sentence =
      file("walk.mcap") +
      ": cannot be written any further (File too large); make room, or name a file on another disk";
  EXPECT_NE(text_of(file("err")).find("stilt: " + sentence + "\n"), std::string::npos)
      << text_of(file("err"));
  EXPECT_NE(text_of(file("out")).find("walk.mcap: 0 messages in 0."), std::string::npos)
      << text_of(file("out"));
  const auto json = nlohmann::json::parse(text_of(file("run.json")));
  EXPECT_EQ(json.at("problem"), sentence);
  EXPECT_EQ(json.at("complete"), false);
  EXPECT_LE(json.at("bytes"), std::filesystem::file_size(file("walk.mcap")));
}

TEST_F(CommandOutput, ARecordOfNothingIsNotInTheWayOfTheNext) {
  for (int times = 0; times < 2; ++times) {
    EXPECT_EQ(run(record_in_own_domain() + "--out " + file("walk.mcap")).status, 1);
    EXPECT_FALSE(std::filesystem::exists(file("walk.mcap")));
  }
}

TEST_F(CommandOutput, ARecordOfNothingSaysSoInTheJsonAndOnStandardError) {
  for (const char* json_file : {"-", "@run.json"}) {
    const Outcome outcome = run_here(record_in_own_domain() + "--out @walk.mcap --json " + json_file);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.errors.find("walk.mcap: nothing was received on domain "), std::string::npos)
        << outcome.errors;
    const bool printed = std::string(json_file) == "-";
    const auto json = nlohmann::json::parse(printed ? outcome.output : text_of(file("run.json")));
    EXPECT_TRUE(json.at("problem").get<std::string>().starts_with("nothing was received on domain "));
    EXPECT_EQ(json.at("bytes"), 0) << "the file is removed";
    EXPECT_EQ(json.at("complete"), false);
  }
}

TEST_F(CommandOutput, ADurationOfARecordIsAboveZero) {
  for (const char* duration : {"-1", "0", "inf"}) {
    for (const std::string& command : {"record --out " + file("a.mcap"), std::string("robot")}) {
      const Outcome outcome = run(command + " --duration " + duration);
      EXPECT_EQ(outcome.status, 2) << command << duration;
      EXPECT_EQ(outcome.errors, std::string("stilt: --duration ") + duration +
                                    ": the duration must be above 0 s; leave it out to run until Ctrl-C\n");
    }
  }
}

}  // namespace
}  // namespace stilt::cli
