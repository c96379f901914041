// Walks in lock-step recorded by stilt record over DDS, and replayed by stilt replay.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "mpc_core/dispatch/dispatched_planner.h"
#include "tests/independent_readers/run_reader.h"
#include "tests/two_processes/recorder.h"

namespace stilt::two_processes {
namespace {

using Json = nlohmann::json;

class Recording : public testing::Test {
 protected:
  void start_recorder() {
    recorder = std::make_unique<Recorder>(run, file);
    ASSERT_TRUE(recorder->records()) << said();
  }

  /// @param duration_s  of the controller's run, three seconds of it standing up
  void start_walk(const std::string& duration_s, const std::string& instruction_set = "auto") {
    run.start_robot({"--lockstep", "--once"});
    run.start_controller({"--lockstep", "--start", "walk@0.5", "--duration", duration_s, "--set",
                          "sqp.instruction_set=" + instruction_set});
  }

  void end_walk() {
    run.expect_both_to_end();
    ASSERT_EQ(run.controller().wait(0), 0) << said();
  }

  /// Exit status of the recorder after the signal to end.
  std::optional<int> end_recorder() { return recorder->end(); }

  /// Replays; gives the exit status and fills `replayed`.
  std::optional<int> replay() {
    Process program({STILT_PROGRAM, "replay", file, "--json", run.file("replay.json")},
                    run.file("replay.out"), run.file("replay.err"));
    const auto status = program.wait(kLongestRun_s);
    replayed = Json::parse(std::ifstream(run.file("replay.json")));
    return status;
  }

  [[nodiscard]] std::string said() const {
    std::string text = run.said();
    for (const char* name :
         {"record.out", "record.err", "record.json", "replay.out", "replay.err", "replay.json"}) {
      if (std::filesystem::exists(run.file(name)))
        text += std::string(name) + ":\n" + text_of(run.file(name));
    }
    return text;
  }

  RobotAndController run;
  std::string file = run.file("walk.mcap");
  std::unique_ptr<Recorder> recorder;
  Json replayed;
};

TEST_F(Recording, a_minute_of_walking_is_recorded_whole_and_replays_bit_for_bit) {
  start_recorder();
  start_walk("64");
  end_walk();
  EXPECT_EQ(end_recorder(), 0) << said();
  EXPECT_TRUE(Json::parse(std::ifstream(run.file("record.json"))).at("problem").is_null());
  EXPECT_EQ(replay(), 0) << said();
  EXPECT_TRUE(replayed.at("reproduced")) << said();
  const Json& replayed_run = replayed.at("runs").at(0);
  EXPECT_EQ(replayed_run.at("ticks"), run.controller_json().at("ticks")) << "every tick of the controller";
  EXPECT_GT(replayed_run.at("plans").get<int>(), 5900);

  const Json found = independent_readers::run_reader("read_mcap.cjs", {file, "index"});
  ASSERT_EQ(found.at("attachments").size(), 2u) << "configuration and robot";
  EXPECT_TRUE(std::ranges::any_of(found.at("attachments"), [](const Json& attachment) {
    const std::string text = attachment.at("text");
    return text.starts_with("# Active configuration, from the shipped configuration of amber3m, --set ");
  })) << found.at("attachments");
  std::vector<std::string> topics;
  for (const Json& message : found.at("messages")) {
    for (const Json& channel : found.at("channels")) {
      if (channel.at("id") == message.at("channel")) topics.push_back(channel.at("topic"));
    }
  }
  for (const char* topic :
       {"/joint_states", "/odom", "/diagnostics", "/stilt/ticks", "/stilt/planner", "/stilt/plan",
        "/stilt/supervisor", "/stilt/event", "/stilt/timing", "/stilt/configuration"}) {
    EXPECT_NE(std::ranges::find(topics, topic), topics.end()) << topic;
  }
}

TEST_F(Recording, a_robot_whose_urdf_is_not_on_the_recording_computer_is_replayed) {
  start_recorder();
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::copy_file(ROBOT_URDF, run.file("own.urdf"));
  std::filesystem::current_path(std::filesystem::path(run.file("own.urdf")).parent_path());
  run.start_robot({"--lockstep", "--once", "--robot", "own.urdf"});
  run.start_controller({"--lockstep", "--robot", "own.urdf", "--duration", "1"});
  std::filesystem::current_path(here);
  end_walk();
  EXPECT_EQ(end_recorder(), 0) << said();
  EXPECT_EQ(replay(), 0) << said();
}

class RecordingWith : public Recording, public testing::WithParamInterface<model::InstructionSet> {};

TEST_P(RecordingWith, a_walk_replays_bit_for_bit_with_the_instruction_set_that_planned_it) {
  const std::string name(model::name_of(GetParam()));
  if (!dispatch::available(GetParam())) GTEST_SKIP() << "this processor has no " << name;
  start_recorder();
  start_walk("8", name);
  end_walk();
  EXPECT_EQ(end_recorder(), 0) << said();
  EXPECT_EQ(replay(), 0) << said();
  EXPECT_TRUE(replayed.at("reproduced")) << said();
  const Json found = independent_readers::run_reader("read_mcap.cjs", {file, "index"});
  EXPECT_TRUE(std::ranges::any_of(found.at("attachments"), [&](const Json& attachment) {
    const std::string text = attachment.at("text");
    return text.find("instruction_set = \"" + name + "\"") != std::string::npos;
  })) << found.at("attachments");
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, RecordingWith,
                         testing::Values(model::InstructionSet::avx2, model::InstructionSet::avx512),
                         [](const auto& test) { return std::string(model::name_of(test.param)); });

TEST_F(Recording, a_recorder_killed_at_work_leaves_a_record_that_opens_and_replays_to_its_end) {
  start_recorder();
  start_walk("20");
  while (!std::filesystem::exists(file) || std::filesystem::file_size(file) < 1'000'000) {
    ASSERT_FALSE(run.controller().wait(0.02)) << said();
  }
  recorder->process().signal(SIGKILL);
  EXPECT_EQ(recorder->process().wait(kLongestRun_s), 128 + SIGKILL);
  end_walk();
  EXPECT_EQ(replay(), 1) << "not all of the run is there" << said();
  EXPECT_EQ(replayed.at("reproduced"), true) << said();
  EXPECT_GT(replayed.at("runs").at(0).at("ticks").get<int>(), 500) << said();
  EXPECT_EQ(replayed.at("file_problems").size(), 1u) << "cut off, and says so";
  const Json found = independent_readers::run_reader("read_mcap.cjs", {file});
  EXPECT_FALSE(found.at("ended"));
  EXPECT_GT(found.at("messages").size(), 100u);
}

TEST_F(Recording, a_recorder_that_comes_too_late_says_what_is_missing_and_so_does_the_replay) {
  start_walk("64");
  while (!std::filesystem::exists(run.file("frames")) ||
         std::filesystem::file_size(run.file("frames")) < 6'000'000) {
    ASSERT_FALSE(run.controller().wait(0.02)) << said();
  }
  start_recorder();
  end_walk();
  EXPECT_EQ(end_recorder(), 1) << said();
  const Json missing = Json::parse(std::ifstream(run.file("record.json"))).at("runs").at(0).at("missing");
  EXPECT_EQ(missing.at(0).at(0), 0) << "the beginning";
  EXPECT_EQ(replay(), 1);
  const std::string problem = replayed.at("runs").at(0).at("problem");
  EXPECT_EQ(problem.find("ticks 0 to "), 0u) << problem;
}

}  // namespace
}  // namespace stilt::two_processes
