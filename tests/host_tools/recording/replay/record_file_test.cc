#include "host_tools/recording/replay/record_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/configuration/live.h"
#include "firmware/robots/robots.h"
#include "firmware/telemetry/cycle_message.h"
#include "firmware/telemetry/sequence.h"
#include "host_tools/recording/record/recorder.h"
#include "host_tools/recording/replay/replay_run.h"
#include "tests/host_tools/recording/mcap/sample_file.h"
#include "tests/host_tools/recording/record_sample.h"
#include "tests/host_tools/recording/replay/recorded_walk.h"

namespace stilt::replay {
namespace {

constexpr std::uint64_t kRun = 7;
constexpr std::size_t kBatch = 20;

telemetry::Sample cycle_sample(std::uint64_t run_id, const control_loop::CycleRecord& record) {
  telemetry::PlannerCycle message = telemetry::cycle_message(record);
  message.run_id = run_id;
  return {&telemetry::kPlannerCycles, 0, 1, telemetry::encode(message)};
}

telemetry::Sample tuning_sample(std::uint64_t run_id, std::uint32_t number, std::vector<double> values) {
  telemetry::Tuning message{};
  message.run_id = run_id;
  message.number = number;
  telemetry::set_view(message.key, "");
  telemetry::set_view(message.commander, "");
  telemetry::set_view(message.values, values);
  return {&telemetry::kTuning, 0, 1, telemetry::encode(message)};
}

telemetry::Sample batch_sample(std::uint64_t run_id, std::span<const control_loop::TickRecord> ticks) {
  telemetry::TickBatchBuilder batch;
  for (const control_loop::TickRecord& tick : ticks) batch.add(tick);
  batch.message().run_id = run_id;
  return {&telemetry::kTicks, 0, 1, telemetry::encode(batch.message())};
}

/// What stiltd reports of itself, with the keys of its live tunables.
telemetry::Sample configuration_sample(std::uint64_t run_id, const configuration::Configuration& active,
                                       const std::string& robot = "amber3m", const std::string& urdf = "") {
  std::string toml = configuration::to_toml(active, "");
  std::vector<std::string> keys;
  for (const auto& tunable : configuration::live_tunables(active)) keys.push_back(tunable.entry->name());
  std::string none;
  std::vector<stilt_msgs_msg_dds__Tunable_> tunables;
  for (std::string& key : keys) tunables.push_back({key.data(), none.data(), none.data(), 0, 0, 0});
  telemetry::ActiveConfiguration message{};
  message.run_id = run_id;
  telemetry::set_view(message.robot, robot.c_str());
  telemetry::set_view(message.configuration, toml);
  telemetry::set_view(message.version, "9.9");
  telemetry::set_view(message.compiler, "gcc");
  telemetry::set_view(message.instruction_set, "avx2");
  telemetry::set_view(message.realtime, "");
  telemetry::set_view(message.token_file, "");
  telemetry::set_view(message.tunables, tunables);
  message.wire_version = telemetry::kWireVersion;
  telemetry::set_view(message.urdf, urdf.c_str());
  return {&telemetry::kConfiguration, 0, 1, telemetry::encode(message)};
}

/// Ticks and solves of the recorded walk; the rest is the test's.
void take_run(record::Recorder& recorder, std::uint64_t run_id) {
  const std::span<const control_loop::TickRecord> ticks = recorded_walk().ticks;
  for (std::size_t first = 0; first < ticks.size(); first += kBatch) {
    recorder.take(batch_sample(run_id, ticks.subspan(first, std::min(kBatch, ticks.size() - first))), 1);
  }
  for (const control_loop::CycleRecord& cycle : recorded_walk().cycles) {
    recorder.take(cycle_sample(run_id, cycle), 2);
  }
}

TEST(RecordFile, ARunHasConfigurationTuningsSolvesAndTicks) {
  const mcap::TemporaryFile file("run");
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(configuration_sample(kRun, recorded_walk().configuration), 1);
    recorder.take(tuning_sample(kRun, 3, {1.5, 2.5}), 1);
    recorder.take(cycle_sample(kRun, recorded_walk().cycles[40]), 1);
    recorder.take(record::ticks_sample(kRun, 0, 20), 1);
  }
  const RecordContents contents = read_contents(file.path());
  ASSERT_EQ(contents.runs.size(), 1u);
  EXPECT_TRUE(contents.problems.empty());
  const RecordedRun& run = contents.runs[0];
  EXPECT_EQ(run.number, kRun);
  EXPECT_TRUE(run.configured);
  EXPECT_EQ(run.robot, "amber3m");
  EXPECT_EQ(run.build, "9.9, gcc, avx2");
  EXPECT_EQ(run.configuration, configuration::to_toml(recorded_walk().configuration, ""));
  EXPECT_EQ(run.tunables.size(), configuration::live_tunables(recorded_walk().configuration).size());
  EXPECT_EQ(run.tunings.at(3), (std::vector{1.5, 2.5}));
  EXPECT_EQ(run.ticks.count(), 20u);
  ASSERT_EQ(run.cycles.size(), 1u);
  const control_loop::CycleRecord &found = run.cycles[0], &wanted = recorded_walk().cycles[40];
  EXPECT_FALSE(compare(wanted, found));
  EXPECT_EQ(found.tick, wanted.tick);
  EXPECT_EQ(found.tuning, wanted.tuning);
  EXPECT_EQ(found.solve_ns, wanted.solve_ns);
}

TEST(RecordFile, AConfigurationOfAnotherWireVersionIsRefusedWhereverItStands) {
  const mcap::TemporaryFile file("versions");
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(record::configuration_sample(kRun, ""), 1);
    recorder.take(record::ticks_sample(kRun, 0, 20), 1);
    recorder.take(record::configuration_sample(kRun + 1, "", telemetry::kWireVersion + 1), 1);
  }
  EXPECT_THROW(static_cast<void>(read_contents(file.path())), std::runtime_error);
}

TEST(RecordFile, AConfigurationInADamagedChunkIsReadFromTheAttachments) {
  const mcap::TemporaryFile file("damaged");
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(configuration_sample(kRun, recorded_walk().configuration, "own.urdf", record::long_urdf()),
                  1);
    recorder.flush();
    recorder.take(record::ticks_sample(kRun, 0, 20), 1);
    recorder.take(configuration_sample(kRun + 1, recorded_walk().configuration, "own.urdf", "edited"), 1);
  }
  ASSERT_TRUE(mcap::damage_first_chunk(file.path()));
  const RecordContents contents = read_contents(file.path());
  EXPECT_EQ(contents.problems.size(), 1u);
  ASSERT_FALSE(contents.runs.empty());
  const RecordedRun& run = contents.runs[0];
  EXPECT_TRUE(run.configured);
  EXPECT_TRUE(run.attached);
  EXPECT_EQ(run.robot, "own.urdf");
  EXPECT_EQ(run.urdf, record::long_urdf());
  EXPECT_EQ(run.build, "9.9, gcc, avx2");
  EXPECT_EQ(run.configuration, configuration::to_toml(recorded_walk().configuration, ""));
}

TEST(RecordFile, SolvesAndTicksThatComeTwiceAreTakenOnce) {
  const mcap::TemporaryFile file("twice");
  {
    record::Recorder recorder(file.path(), {});
    for (const std::size_t cycle : {0u, 1u, 1u, 0u, 2u}) {
      recorder.take(cycle_sample(kRun, recorded_walk().cycles[cycle]), 1);
    }
    for (const std::uint64_t first : {0u, 10u, 10u, 30u}) {
      recorder.take(record::ticks_sample(kRun, first, 20), 1);
    }
  }
  const RecordContents contents = read_contents(file.path());
  ASSERT_EQ(contents.runs.at(0).cycles.size(), 3u);
  EXPECT_FALSE(contents.runs[0].configured);
  std::uint64_t next = 0;
  for_each_tick(file.path(), kRun, [&](const control_loop::TickRecord& tick) {
    EXPECT_EQ(tick.tick, next++);
    return true;
  });
  EXPECT_EQ(next, 50u);
}

TEST(RecordFile, TicksAreThoseOfTheirRunUntilTheyAreEnough) {
  const mcap::TemporaryFile file("runs");
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(record::ticks_sample(8, 0, 5), 1);
    recorder.take(record::ticks_sample(kRun, 0, 20), 1);
    recorder.take(record::ticks_sample(8, 5, 5), 1);
    recorder.take(record::ticks_sample(kRun, 20, 20), 1);
  }
  EXPECT_EQ(read_contents(file.path()).runs.size(), 2u);
  int ticks = 0;
  for_each_tick(file.path(), 8, [&](const control_loop::TickRecord&) { return ++ticks < 100; });
  EXPECT_EQ(ticks, 10);
  for_each_tick(file.path(), kRun, [&](const control_loop::TickRecord&) { return ++ticks < 13; });
  EXPECT_EQ(ticks, 13);
}

TEST(ReplayRun, TheRecordedWalkComesOutTheSameWithItsTunings) {
  const mcap::TemporaryFile file("walk");
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(configuration_sample(kRun, recorded_walk().configuration), 1);
    for (const auto& [number, values] : recorded_walk().live_values) {
      recorder.take(tuning_sample(kRun, number, values), 1);
    }
    take_run(recorder, kRun);
  }
  std::vector<std::uint64_t> progress;
  const RecordContents contents = read_contents(file.path());
  const Outcome outcome =
      replay_run(file.path(), contents.runs.at(0), [&](std::uint64_t tick) { progress.push_back(tick); });
  EXPECT_TRUE(outcome.reproduced()) << outcome.problem
                                    << (outcome.difference ? outcome.difference->text() : "");
  EXPECT_EQ(outcome.ticks, recorded_walk().ticks.size());
  EXPECT_EQ(outcome.cycles, recorded_walk().cycles.size());
  EXPECT_EQ(progress, (std::vector<std::uint64_t>{0, 1000, 2000, 3000}));
}

/// A run of the recorded walk in a record, and how its replay ends.
Outcome replayed(const std::function<void(record::Recorder&)>& take_more) {
  const mcap::TemporaryFile file("part");
  {
    record::Recorder recorder(file.path(), {});
    take_more(recorder);
  }
  return replay_run(file.path(), read_contents(file.path()).runs.at(0));
}

/// The walk of a robot whose URDF file is gone: its description in the record gives every plan and torque.
TEST(ReplayRun, ARobotOfAUrdfIsTheOneThatWasRun) {
  const mcap::TemporaryFile file("attached");
  const std::string robot = file.path() + ".urdf";
  configuration::Configuration active = recorded_walk().configuration;
  active.hardware.robot = robot;
  for (const bool shipped : {true, false}) {
    file.set_bytes({});
    {
      const std::string urdf(shipped ? robots::shipped_urdfs().front().text : record::long_urdf());
      record::Recorder recorder(file.path(), {});
      recorder.take(configuration_sample(kRun, active, robot, urdf), 1);
      for (const auto& [number, values] : recorded_walk().live_values) {
        recorder.take(tuning_sample(kRun, number, values), 1);
      }
      take_run(recorder, kRun);
    }
    const Outcome outcome = replay_run(file.path(), read_contents(file.path()).runs.at(0));
    EXPECT_EQ(outcome.reproduced(), shipped) << outcome.problem;
    EXPECT_EQ(outcome.problem, "");
  }
}

/// The file was edited between two runs of one record.
TEST(ReplayRun, EachRunHasItsOwnRobotOfOneName) {
  const mcap::TemporaryFile file("edited");
  const std::string robot = file.path() + ".urdf";
  configuration::Configuration active = recorded_walk().configuration;
  active.hardware.robot = robot;
  {
    record::Recorder recorder(file.path(), {});
    for (const std::uint64_t number : {kRun, kRun + 1}) {
      const std::string urdf(number == kRun ? robots::shipped_urdfs().front().text : record::long_urdf());
      recorder.take(configuration_sample(number, active, robot, urdf), 1);
      for (const auto& [tuning, values] : recorded_walk().live_values) {
        recorder.take(tuning_sample(number, tuning, values), 1);
      }
      take_run(recorder, number);
    }
  }
  const RecordContents contents = read_contents(file.path());
  ASSERT_EQ(contents.runs.size(), 2u);
  EXPECT_FALSE(replay_run(file.path(), contents.runs[1]).reproduced());
  EXPECT_TRUE(replay_run(file.path(), contents.runs[0]).reproduced());
}

TEST(ReplayRun, AUrdfThatIsNoneIsRefused) {
  const auto& active = recorded_walk().configuration;
  const std::string problem = replayed([&](auto& recorder) {
                                recorder.take(configuration_sample(kRun, active, "own.urdf", "none"), 1);
                              }).problem;
  EXPECT_TRUE(problem.starts_with("its robot's description is refused by this program: own.urdf: "))
      << problem;
}

TEST(ReplayRun, WhatTheRecordLacksIsReported) {
  const configuration::Configuration& active = recorded_walk().configuration;
  EXPECT_EQ(replayed([](auto& recorder) { take_run(recorder, kRun); }).problem,
            "its configuration is missing in the record; record from before stiltd ends");
  EXPECT_EQ(replayed([&](auto& recorder) { recorder.take(configuration_sample(kRun, active), 1); }).problem,
            "the record holds no ticks of it");
  EXPECT_NE(replayed([&](auto& recorder) {
              recorder.take(configuration_sample(kRun, active), 1);
              take_run(recorder, kRun);
            }).problem.find("tuning 1 of "),
            std::string::npos);
  EXPECT_NE(replayed([&](auto& recorder) {
              recorder.take(record::configuration_sample(kRun, "gait = 1"), 1);
            }).problem.find("the recorded configuration is refused by this program: "),
            std::string::npos);
}

TEST(ReplayRun, ADamagedRecordIsReplayedUntilKeysOfTunablesAreNeeded) {
  const mcap::TemporaryFile file("damaged");
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(configuration_sample(kRun, recorded_walk().configuration), 1);
    recorder.flush();
    for (const auto& [number, values] : recorded_walk().live_values) {
      recorder.take(tuning_sample(kRun, number, values), 1);
    }
    take_run(recorder, kRun);
  }
  ASSERT_TRUE(mcap::damage_first_chunk(file.path()));
  const Outcome outcome = replay_run(file.path(), read_contents(file.path()).runs.at(0));
  EXPECT_TRUE(outcome.problem.starts_with("tuning 1 of ")) << outcome.problem;
  EXPECT_NE(outcome.problem.find(" has keys that are damaged in the record"), std::string::npos)
      << outcome.problem;
  EXPECT_GT(outcome.ticks, 0u);
}

TEST(ReplayRun, KeysThatWereRenamedSinceAreReadUnderTheirNewNames) {
  std::string toml = configuration::to_toml(recorded_walk().configuration, "");
  const std::string now = "base_pitch_limit_rad", then = "base_angle_limit_rad";
  toml.replace(toml.find(now), now.size(), then);
  RecordedRun run;
  run.configured = true;
  run.configuration = toml;
  const auto read = configuration_of(run);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->supervisor.base_pitch_limit_rad,
            recorded_walk().configuration.supervisor.base_pitch_limit_rad);
  run.configuration = "[inequality]\nminimum_normal_force_N = 20";
  const auto refused = configuration_of(run);
  ASSERT_FALSE(refused);
  EXPECT_TRUE(
      refused.error().starts_with("the recorded configuration is refused by this program: the recorded "
                                  "configuration:2:1: minimum_normal_force_N is now"))
      << refused.error();
}

TEST(ReplayRun, TuningsOfAProgramWithOtherTunablesAreNotApplied) {
  const Outcome outcome = replayed([](record::Recorder& recorder) {
    std::string toml = configuration::to_toml(recorded_walk().configuration, "");
    recorder.take(record::configuration_sample(kRun, toml), 1);  // names no tunables
    for (const auto& [number, values] : recorded_walk().live_values) {
      recorder.take(tuning_sample(kRun, number, values), 1);
    }
    take_run(recorder, kRun);
  });
  EXPECT_TRUE(outcome.problem.starts_with("tuning 1 of ")) << outcome.problem;
  EXPECT_NE(outcome.problem.find(" is of a program with other live tunables; replay it with stilt of "),
            std::string::npos)
      << outcome.problem;
  EXPECT_FALSE(outcome.difference);
}

}  // namespace
}  // namespace stilt::replay
