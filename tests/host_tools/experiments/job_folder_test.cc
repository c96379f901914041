#include "host_tools/experiments/job_folder.h"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <stdexcept>

#include "host_tools/experiments/job_processes.h"
#include "tests/own_folder.h"

namespace stilt::experiments {
namespace {

class JobFolderTest : public testing::Test {
 protected:
  tests::OwnFolder own_;
  std::filesystem::path folder_ = own_.path() / "jobs";  ///< made by the first JobFolder
  std::vector<Job> jobs_ = {{"a", [] { return Json{{"value", 1}}; }},
                            {"b", [] { return Json{{"value", 2}}; }}};
};

TEST_F(JobFolderTest, KnowsWhatIsMissingAndGivesResultsInOrderOfTheJobs) {
  const JobFolder folder(folder_, {{"experiment", "x"}});
  folder.keep("b", jobs_[1].run());
  EXPECT_EQ(folder.missing(jobs_), std::vector<std::string>{"a"});
  EXPECT_THROW((void)folder.results(jobs_), std::invalid_argument);
  folder.keep("a", jobs_[0].run());
  const JobFolder again(folder_, {{"experiment", "x"}});
  EXPECT_TRUE(again.missing(jobs_).empty());
  EXPECT_EQ(again.results(jobs_), (std::vector<Json>{{{"value", 1}}, {{"value", 2}}}));
}

/// What a folder made with some settings says about others; empty when it accepts them.
std::string refusal(const std::filesystem::path& folder, const Json& settings) {
  try {
    (void)JobFolder(folder, settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST_F(JobFolderTest, RefusesResultsOfOtherSettingsAndNamesTheDifference) {
  const Json settings = {{"experiment", "x"}, {"commit", "abc"}, {"configuration", {{"row", "1"}}}};
  const JobFolder folder(folder_, settings);
  EXPECT_EQ(refusal(folder_, settings), "");
  Json other = settings;
  other["commit"] = "def";
  EXPECT_NE(refusal(folder_, other).find("another commit (abc there, def here)"), std::string::npos);
  other = settings;
  other["configuration"]["row"] = "2";
  EXPECT_NE(refusal(folder_, other).find("another configuration of row;"), std::string::npos);
  other = settings;
  other.erase("commit");
  EXPECT_NE(refusal(folder_, other).find("another commit (abc there, none here)"), std::string::npos);
  EXPECT_EQ(refusal(folder_, settings), "") << "a refused program leaves the folder as it is";
}

TEST_F(JobFolderTest, TakesFurtherPartsOfAnExperimentAndKeepsTheirConfiguration) {
  const auto settings = [](const char* part, const char* hash) {
    return Json{{"experiment", "x"}, {"configuration", {{part, hash}}}};
  };
  const JobFolder folder(folder_, settings("a", "1"));
  EXPECT_EQ(refusal(folder_, settings("b", "2")), "");
  EXPECT_EQ(refusal(folder_, settings("a", "1")), "");
  EXPECT_NE(refusal(folder_, settings("a", "3")), "");
  EXPECT_NE(refusal(folder_, settings("b", "3")), "");
}

TEST_F(JobFolderTest, RefusesAResultThatIsDamaged) {
  const JobFolder folder(folder_, {});
  for (const char* text : {R"({"value": )", "{}", "[1]", "null"}) {
    std::ofstream(folder_ / "a.json") << text;
    EXPECT_THROW((void)folder.result("a"), std::runtime_error) << text;
  }
}

TEST_F(JobFolderTest, RefusesSettingsThatAreNone) {
  (void)JobFolder(folder_, {{"experiment", "x"}});
  std::ofstream(folder_ / "settings.json") << "[1]";
  EXPECT_THROW(JobFolder(folder_, {{"experiment", "x"}}), std::runtime_error);
}

TEST_F(JobFolderTest, NamesThatAreNotUtf8LoseNoResult) {
  const Json settings = {{"experiment", "x"}, {"gaits", "caf\xe9"}, {"set", {"a=\xe9"}}};
  const JobFolder folder(folder_, settings);
  EXPECT_EQ(refusal(folder_, settings), "") << "the same again";
  folder.keep("a", {{"file", "caf\xe9"}});
  EXPECT_EQ(folder.result("a").at("file"), "caf\xef\xbf\xbd");
}

/// As a parent may leave it: no end of a process is reported then.
TEST(JobProcesses, EndWhereTheSignalOfTheirEndIsIgnored) {
  std::signal(SIGCHLD, SIG_IGN);
  std::vector<int> done;
  run_in_processes({"/bin/true"}, {"a", "b", "c"}, 2, [&](int jobs) { done.push_back(jobs); });
  EXPECT_EQ(done, (std::vector<int>{1, 2, 3}));
  EXPECT_THROW(run_in_processes({"/bin/false"}, {"a"}, 2, [](int) {}), std::runtime_error);
}

TEST_F(JobFolderTest, RefusesAFolderThatCannotBe) {
  EXPECT_THROW(JobFolder("/proc/nowhere", {}), std::invalid_argument);
}

}  // namespace
}  // namespace stilt::experiments
