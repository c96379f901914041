// Where the files that commands write may be.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/host_tools/program_test.h"
#include "tests/own_domain.h"

namespace stilt::cli {
namespace {

using testing_support::Outcome;
using testing_support::text_of;

class CommandOutput : public testing_support::ProgramTest {
 protected:
  CommandOutput() { std::ofstream(file("in.toml")) << "a file"; }

  /// @param arguments  with @ for the test's folder
  Outcome run_here(std::string arguments) const {
    const std::string folder = file("");
    for (auto at = arguments.find('@'); at != std::string::npos; at = arguments.find('@')) {
      arguments.replace(at, 1, folder);
    }
    return run(arguments);
  }
};

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

TEST_F(CommandOutput, ARecordHasTheProblemNull) {
  EXPECT_EQ(run(record_in_own_domain() + "--out /dev/null --json " + file("run.json")).status, 1);
  EXPECT_TRUE(nlohmann::json::parse(text_of(file("run.json"))).at("problem").is_null());
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
