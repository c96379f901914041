// Where the files that commands write may be.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/host_tools/program_test.h"

namespace stilt::cli {
namespace {

using testing_support::Outcome;
using testing_support::text_of;

class CommandOutput : public testing_support::ProgramTest {};

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

}  // namespace
}  // namespace stilt::cli
