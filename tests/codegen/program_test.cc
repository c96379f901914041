#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/own_folder.h"

namespace {

namespace fs = std::filesystem;

struct Outcome {
  int exit_status = -1;
  std::string text;  ///< of both output streams
};

Outcome run(const std::string& arguments) {
  const std::string command = std::string(STILT_CODEGEN) + " " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    outcome.text.append(buffer.data(), count);
  }
  outcome.exit_status = WEXITSTATUS(pclose(pipe));
  return outcome;
}

std::string read(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class ProgramTest : public testing::Test {
 protected:
  stilt::tests::OwnFolder folder;
  fs::path out = folder.path() / "out";
};

TEST_F(ProgramTest, ItWritesTheCommittedHeaders) {
  const Outcome outcome =
      run("--urdf " STILT_SOURCE_DIR "/codegen/robots/amber3m.urdf --shape five_link --out " + out.string());
  EXPECT_EQ(outcome.exit_status, 0);
  EXPECT_EQ(outcome.text, "");
  for (const char* name : {"constants.h", "kinematics.h", "node.h", "impact.h"}) {
    EXPECT_TRUE(read(out / "five_link" / name) ==
                read(fs::path(STILT_SOURCE_DIR "/codegen/generated/five_link") / name));
  }
}

TEST_F(ProgramTest, HelpShowsTheUsage) {
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.exit_status, 0);
  EXPECT_NE(outcome.text.find("usage: stilt_codegen --urdf FILE --shape NAME --out DIR"), std::string::npos);
}

TEST_F(ProgramTest, BadUsageIsOneSentenceAndStatusTwo) {
  for (const char* arguments :
       {"", "--urdf a.urdf", "--urdf", "--color red", "--urdf a.urdf --shape 3m --out ."}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_status, 2) << arguments;
    EXPECT_EQ(std::ranges::count(outcome.text, '\n'), 1) << outcome.text;
  }
}

struct BadInput {
  const char* name;
  const char* sentence;  ///< what the message must contain
};

class BadInputTest : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputTest, IsOneSentenceAndStatusTwo) {
  const stilt::tests::OwnFolder folder;
  const fs::path out = folder.path() / "out";
  const std::string file = std::string(STILT_SOURCE_DIR "/tests/codegen/data/") + GetParam().name + ".urdf";
  const Outcome outcome = run("--urdf " + file + " --shape robot --out " + out.string());
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_EQ(std::ranges::count(outcome.text, '\n'), 1) << outcome.text;
  EXPECT_NE(outcome.text.find(GetParam().sentence), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find(file), std::string::npos) << outcome.text;
  EXPECT_FALSE(fs::exists(out));
}

INSTANTIATE_TEST_SUITE_P(
    Urdf, BadInputTest,
    testing::Values(BadInput{"missing", "cannot be read"}, BadInput{"not_xml", "not valid XML in line"},
                    BadInput{"other_root", "the root element is not <robot>"},
                    BadInput{"not_planar", "not planar: joint 'hip' does not turn about the y axis"},
                    BadInput{"tilted_joint",
                             "not planar: the origin of joint 'hip' is turned out of the x-z plane"},
                    BadInput{"two_parents", "not a tree: link 'leg' is the child of joints 'hip' and 'hand'"},
                    BadInput{"two_roots", "not a tree: links 'stray' and 'torso' both have no parent"},
                    BadInput{"loop", "not a tree: the joints above link 'arm' form a loop"},
                    BadInput{"massless_link", "moving link 'leg' has no mass"},
                    BadInput{"no_inertia", "moving link 'leg' has no moment of inertia"},
                    BadInput{"no_foot", "there is no foot frame"},
                    BadInput{"heavy_foot", "'foot_L' has a mass"},
                    BadInput{"no_limits", "joint 'hip' has no torque or speed limit"},
                    BadInput{"sliding_joint", "joint 'hip' is neither revolute, continuous nor fixed"},
                    BadInput{"unknown_link", "joint 'hip' names link 'lag', which does not exist"},
                    BadInput{"bad_transmission", "names joint 'hop', which does not exist"},
                    BadInput{"bad_number", "the URDF parser refuses it: "}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace
