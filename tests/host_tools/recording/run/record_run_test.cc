#include "host_tools/recording/run/record_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_tools/recording/record/recorder.h"
#include "tests/host_tools/recording/mcap/sample_file.h"
#include "tests/host_tools/recording/record_sample.h"
#include "tests/own_folder.h"

namespace stilt::record {
namespace {

TEST(RecordRun, TheRunWithMostTicksIsTaken) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.mcap");
  Recorder recorder(file, {});
  for (const auto& [run, batches] : {std::pair<std::uint64_t, std::uint64_t>{7, 1}, {8, 4}, {9, 2}}) {
    recorder.take(configuration_sample(run, ""), 1);
    recorder.take(event_sample(run, "event of " + std::to_string(run)), 2);
    for (std::uint64_t i = 0; i < batches; ++i) recorder.take(ticks_sample(run, 50 * i, 50), 3);
  }
  recorder.close();

  const RecordRun found = run_of_record(file);
  EXPECT_EQ(found.runs, 3u);
  EXPECT_TRUE(found.problems.empty());
  EXPECT_EQ(found.run.robot.name, "amber3m");
  EXPECT_GT(found.robot.thigh_length_m, 0.1);
  ASSERT_EQ(found.run.samples.size(), 40u) << "one of five ticks";
  const log::RunSample& sample = found.run.samples[1];
  EXPECT_NEAR(sample.time_s, 5.005, 1e-9) << "the configuration says that the clock was 0 at tick 0";
  EXPECT_EQ(sample.estimated_state[1], 0.75);
  EXPECT_TRUE(std::isnan(sample.true_state[1])) << "it is unknown";
  EXPECT_TRUE(std::isnan(sample.planned_state[1])) << "no plan is in use";
  EXPECT_NEAR(found.run.summary.duration_s, 0.199, 1e-9);
  EXPECT_EQ(found.run.controller->last_state, "boot");
  ASSERT_EQ(found.run.controller->events.size(), 1u);
  EXPECT_EQ(found.run.controller->events[0].text, "event of 8");
  EXPECT_EQ(found.run.controller->events[0].time_s, 0.1);
}

/// A record of a URDF robot, whose file is another one by now or gone.
TEST(RecordRun, TheRobotIsTheOneThatWasRun) {
  for (const bool gone : {true, false}) {
    const tests::OwnFolder folder;
    const std::string file = folder.file("walk.mcap");
    const std::string robot = folder.file(gone ? "gone.urdf" : "edited.urdf");
    if (!gone) std::ofstream(robot) << "edited";
    Recorder recorder(file, {});
    recorder.take(configuration_sample(7, "", telemetry::kWireVersion, robot, 0, long_urdf()), 1);
    recorder.take(ticks_sample(7, 0, 50), 3);
    recorder.close();
    const RecordRun found = run_of_record(file);
    EXPECT_EQ(found.robot.thigh_length_m, kLongThigh_m);
    ASSERT_NE(found.robot.name, nullptr);
    EXPECT_EQ(found.robot.name, robot);
    EXPECT_TRUE(found.problems.empty());
  }
}

TEST(RecordRun, WithoutAURDFOfTheRobotTheSentenceNamesIt) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.mcap");
  Recorder recorder(file, {});
  recorder.take(configuration_sample(7, "", telemetry::kWireVersion, "/nowhere/own.urdf"), 1);
  recorder.take(ticks_sample(7, 0, 50), 3);
  recorder.close();
  try {
    static_cast<void>(run_of_record(file));
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).substr(file.size()),
              ": the record has no URDF of its robot: /nowhere/own.urdf: cannot be read (No such file or "
              "directory); give the path of a URDF file");
  }
}

TEST(RecordRun, AConfigurationOfAnotherReleaseIsReportedAndTheRunIsRead) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.mcap");
  Recorder recorder(file, {});
  recorder.take(configuration_sample(7, "[gait]\nhops = 1"), 1);
  recorder.take(ticks_sample(7, 0, 50), 3);
  recorder.close();
  const RecordRun found = run_of_record(file);
  EXPECT_FALSE(found.run.samples.empty());
  ASSERT_EQ(found.problems.size(), 1U);
  EXPECT_EQ(
      found.problems[0].substr(file.size()),
      ": the recorded configuration is refused by this program: the recorded configuration:2:1: unknown key "
      "gait.hops; the shipped files name every key; the run is read without its limits and settings");
}

TEST(RecordRun, TheTorqueLimitsAreThoseThatTheConfigurationAllows) {
  const auto limits_of = [](const std::string& toml) {
    const tests::OwnFolder folder;
    const std::string file = folder.file("walk.mcap");
    Recorder recorder(file, {});
    recorder.take(configuration_sample(7, toml), 1);
    recorder.take(ticks_sample(7, 0, 50), 3);
    recorder.close();
    std::vector<double> shares;
    const RecordRun found = run_of_record(file);
    for (const auto& allowed_Nm : found.run.allowed_torque_Nm) {
      shares.push_back(allowed_Nm[1] / found.robot.torque_limit_Nm[1]);
    }
    return shares;
  };
  EXPECT_EQ(limits_of(""), std::vector<double>{1.0});
  EXPECT_EQ(limits_of("[supervisor]\ntorque_limit_share = 0.5\n"), std::vector<double>{0.5});
  EXPECT_EQ(limits_of("[robot]\ntorque_limit_scale = 0.25\n[supervisor]\ntorque_limit_share = 0.5\n"),
            (std::vector<double>{0.5, 0.25}));
}

TEST(RecordRun, TicksThatAreMissingInTheMiddleAreReported) {
  const auto problems = [](std::uint64_t first, std::uint64_t second) {
    const tests::OwnFolder folder;
    const std::string file = folder.file("walk.mcap");
    Recorder recorder(file, {});
    recorder.take(configuration_sample(7, ""), 1);
    recorder.take(ticks_sample(7, first, 50), 3);
    recorder.take(ticks_sample(7, second, 50), 3);
    recorder.close();
    std::string text;
    for (const std::string& problem : run_of_record(file).problems) text += problem.substr(file.size());
    return text;
  };
  EXPECT_EQ(problems(0, 50), "");
  EXPECT_EQ(problems(1000, 1050), "") << "the recorder came later";
  EXPECT_EQ(problems(0, 2000), ": ticks 0 to 2049, missing: 50 to 1999; plots have a break there");
}

TEST(RecordRun, AConfigurationInADamagedChunkIsReadFromTheAttachments) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.mcap");
  {
    Recorder recorder(file, {});
    recorder.take(configuration_sample(7, "[inequality]\nfriction_coefficient = 0.55\n",
                                       telemetry::kWireVersion, "own.urdf", 5'000'000'000, long_urdf()),
                  1);
    recorder.flush();
    recorder.take(ticks_sample(7, 100, 50), 3);
    recorder.close();
  }
  ASSERT_TRUE(mcap::damage_first_chunk(file));
  const RecordRun found = run_of_record(file);
  EXPECT_EQ(found.problems.size(), 1U) << "the damage is reported";
  EXPECT_EQ(found.run.robot.name, "own.urdf");
  EXPECT_EQ(found.robot.thigh_length_m, kLongThigh_m);
  EXPECT_EQ(found.run.friction_coefficient, 0.55);
  EXPECT_NEAR(found.run.samples.at(0).time_s, 0.1, 1e-9) << "tick 0 is 100 ms before the first that is there";
}

TEST(RecordRun, AnAttachedConfigurationOfAnotherWireVersionIsRefused) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.mcap");
  {
    Recorder recorder(file, {});
    recorder.take(configuration_sample(7, "", telemetry::kWireVersion + 1), 1);
    recorder.flush();
    recorder.take(ticks_sample(7, 0, 50), 3);
    recorder.close();
  }
  ASSERT_TRUE(mcap::damage_first_chunk(file));
  EXPECT_THROW(static_cast<void>(run_of_record(file)), std::runtime_error);
}

TEST(RecordRun, WithoutConfigurationInADamagedRecordTheDamageIsTheReason) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.mcap");
  {
    Recorder recorder(file, {});
    recorder.take(event_sample(7, "up"), 1);
    recorder.flush();
    recorder.take(ticks_sample(7, 0, 50), 3);
    recorder.close();
  }
  ASSERT_TRUE(mcap::damage_first_chunk(file));
  try {
    static_cast<void>(run_of_record(file));
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    const std::string sentence = error.what();
    EXPECT_TRUE(sentence.starts_with(file + ": lacks the configuration of its run; ")) << sentence;
    EXPECT_EQ(sentence.find("record from before"), std::string::npos) << sentence;
    EXPECT_EQ(sentence.rfind(file), 0U) << sentence;
  }
}

TEST(RecordRun, WithoutTicksOrConfigurationItIsRefused) {
  const auto complaint = [](const telemetry::Sample& sample, bool damaged = false) {
    const tests::OwnFolder folder;
    const std::string file = folder.file("part.mcap");
    Recorder recorder(file, {});
    recorder.take(sample, 1);
    recorder.close();
    if (damaged) {
      std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
      bytes.seekp(200);
      bytes.put('\xff');
    }
    try {
      static_cast<void>(run_of_record(file));
    } catch (const std::runtime_error& error) {
      return std::string(error.what()).substr(file.size());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(complaint(configuration_sample(7, "")),
            ": holds no ticks of stiltd; name a record of stilt record");
  EXPECT_EQ(complaint(ticks_sample(7, 0, 50)),
            ": lacks the configuration of its run; record from before stiltd ends");
  const std::string damaged = complaint(ticks_sample(7, 0, 50), true);
  EXPECT_TRUE(damaged.starts_with(": holds no ticks of stiltd that can be read: ")) << damaged;
}

}  // namespace
}  // namespace stilt::record
