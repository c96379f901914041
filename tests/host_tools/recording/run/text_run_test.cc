#include "host_tools/recording/run/text_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "firmware/diagnostics/tick_csv.h"
#include "firmware/robots/robots.h"
#include "host_tools/recording/sample_log.h"
#include "tests/own_folder.h"

namespace stilt::record {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

model::RobotConstants amber3m() { return (*robots::find("amber3m"))->model.constants; }

/// Samples of a robot whose left foot is in the air from 0.1 s to 0.2 s; it moves by 1 m/s.
log::RunRecord short_run() {
  log::RunRecord run;
  for (int i = 0; i < 100; ++i) {
    log::RunSample& sample = run.samples.emplace_back();
    sample.time_s = 0.005 * i;
    sample.true_state.setConstant(0.25);
    sample.true_state[0] = sample.time_s;
    sample.estimated_state.setConstant(kNan);
    sample.planned_state.setConstant(0.5);
    sample.torque_Nm << 1.0, -40.0 + i, 3.0, 4.0;
    sample.contact_force_N << 1.0, i >= 20 && i < 40 ? 0.0 : 100.0, 2.0, 100.0;
    sample.planned_contact_force_N.setConstant(7.0);
    sample.foot_position_m << 0.3, 0.0, 0.1, 0.0;
    sample.scheduled_mode = {true, false};
    sample.push_N = 12.0;
    sample.push_above_hip_m = 0.285;
    sample.commanded_speed_m_s = kNan;
  }
  return run;
}

std::string complaint_of(const std::string& path, bool ticks) {
  try {
    static_cast<void>(ticks ? run_of_ticks(path, amber3m()) : run_of_samples(path, amber3m()));
  } catch (const std::runtime_error& error) {
    return std::string(error.what()).substr(path.size());
  }
  return "accepted";
}

TEST(SampleRun, ALogIsReadBackWithItsStepsAndWithoutAnOutcome) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.jsonl");
  const log::RunRecord written = short_run();
  log::write_sample_log(written, file);
  const RecordRun read = run_of_samples(file, amber3m());
  EXPECT_TRUE(read.problems.empty());
  EXPECT_FALSE(read.run.outcome_known);
  EXPECT_FALSE(read.run.controller);
  ASSERT_EQ(read.run.samples.size(), 100u);
  const log::RunSample &mine = written.samples[30], &got = read.run.samples[30];
  EXPECT_EQ(got.time_s, mine.time_s);
  EXPECT_EQ(got.true_state, mine.true_state);
  EXPECT_TRUE(std::isnan(got.estimated_state[3]));
  EXPECT_EQ(got.planned_state, mine.planned_state);
  EXPECT_EQ(got.torque_Nm, mine.torque_Nm);
  EXPECT_EQ(got.contact_force_N, mine.contact_force_N);
  EXPECT_EQ(got.planned_contact_force_N, mine.planned_contact_force_N);
  EXPECT_EQ(got.foot_position_m, mine.foot_position_m);
  EXPECT_TRUE(got.scheduled_mode.left && !got.scheduled_mode.right);
  EXPECT_EQ(got.push_N, 12.0);
  EXPECT_EQ(got.push_above_hip_m, 0.285);
  EXPECT_TRUE(std::isnan(got.commanded_speed_m_s));
  const log::RunSummary& summary = read.run.summary;
  ASSERT_EQ(summary.steps.size(), 1u);
  EXPECT_EQ(summary.steps[0].foot, "L");
  EXPECT_NEAR(summary.steps[0].time_s, 0.2, 1e-9);
  EXPECT_NEAR(summary.step_length_max_m, 0.2, 1e-9);
  EXPECT_NEAR(summary.mean_speed_m_s, 1.0, 1e-9);
  EXPECT_EQ(summary.peak_torque_Nm[1], 59.0);
  EXPECT_EQ(summary.peak_joint_speed_rad_s[3], 0.25);
}

TEST(SampleRun, ALogThatWasCutOffIsReadUpToThereAndSaysSo) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.jsonl");
  log::write_sample_log(short_run(), file);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 20);
  const RecordRun read = run_of_samples(file, amber3m());
  EXPECT_EQ(read.run.samples.size(), 99u);
  ASSERT_EQ(read.problems.size(), 1u);
  EXPECT_EQ(read.problems[0], file + ": line 100 is no sample of --log; the report ends before it");
  std::ofstream(file) << "{}\n";
  EXPECT_EQ(complaint_of(file, false),
            ": holds no sample; name a file of stilt sim --log or stilt robot --log");
}

/// At 0.2 m/s up to 3 s, at 1 m/s after that.
TEST(SampleRun, TheMeanSpeedCountsFromThreeSecondsOnWhereTheRunIsLonger) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.jsonl");
  log::RunRecord written;
  for (const double time_s : {0.0, 1.5, 3.0, 3.5, 4.0}) {
    log::RunSample& sample = written.samples.emplace_back(short_run().samples.front());
    sample.time_s = time_s;
    sample.true_state[0] = time_s < 3.0 ? 0.2 * time_s : 0.6 + (time_s - 3.0);
  }
  log::write_sample_log(written, file);
  EXPECT_NEAR(run_of_samples(file, amber3m()).run.summary.mean_speed_m_s, 1.0, 1e-9);
  written.samples.resize(3);
  log::write_sample_log(written, file);
  EXPECT_NEAR(run_of_samples(file, amber3m()).run.summary.mean_speed_m_s, 0.2, 1e-9) << "all of the run";
}

TEST(SampleRun, ALogOfRelease01LacksThePlaceOfThePush) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("walk.jsonl");
  log::RunRecord written = short_run();
  written.samples.resize(1);
  log::write_sample_log(written, file);
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  std::string line = text.str();
  const std::string key = R"("push_above_hip_m":0.285,)";
  ASSERT_NE(line.find(key), std::string::npos) << line;
  line.erase(line.find(key), key.size());
  std::ofstream(file) << line;
  const RecordRun read = run_of_samples(file, amber3m());
  ASSERT_EQ(read.run.samples.size(), 1u);
  EXPECT_EQ(read.run.samples[0].push_above_hip_m, 0.0);
}

/// Two seconds of a robot that stands, then falls, or is in another state.
std::string ticks_text(supervisor::State last = supervisor::State::fault, std::uint64_t count = 2000) {
  std::ostringstream text;
  diagnostics::write_tick_header(text);
  for (std::uint64_t i = 0; i < count; ++i) {
    control_loop::TickRecord tick;
    tick.tick = 7000 + i;
    tick.time_ns = 1'000'000'000 + static_cast<std::int64_t>(i) * 1'000'000;
    tick.state = i < 1000 ? supervisor::State::stand : last;
    if (i >= 1000) tick.present.add(supervisor::Fault::stale_plan);
    tick.estimated_state[0] = 0.001 * static_cast<double>(i);
    tick.estimated_state[1] = 0.75;
    tick.estimated_state[6] = 0.5;
    tick.joints[3].torque_Nm = -25.0;
    tick.joints[3].velocity_rad_s = 2.0;
    tick.base.left_foot_force_N = kNan;
    diagnostics::write_tick(text, tick, 1'000'000'000);
  }
  return text.str();
}

TEST(BlackBoxRun, TicksBecomeARunWithItsStatesAndFaultsAsEvents) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("fault.csv");
  std::ofstream(file) << ticks_text();
  const RecordRun read = run_of_ticks(file, amber3m());
  EXPECT_TRUE(read.problems.empty());
  ASSERT_EQ(read.run.samples.size(), 400u);
  const log::RunSample& sample = read.run.samples[10];
  EXPECT_NEAR(sample.time_s, 0.05, 1e-9);
  EXPECT_EQ(sample.estimated_state[1], 0.75);
  EXPECT_EQ(sample.estimated_state[6], 0.5);
  EXPECT_EQ(sample.torque_Nm[3], -25.0);
  EXPECT_TRUE(std::isnan(sample.commanded_speed_m_s));
  EXPECT_TRUE(std::isnan(sample.contact_force_N[1]));
  EXPECT_EQ(read.run.summary.peak_joint_speed_rad_s[3], 2.0);
  EXPECT_NEAR(read.run.summary.distance_m, 0.999, 1e-9) << "while it was on its feet";
  ASSERT_TRUE(read.run.controller);
  EXPECT_EQ(read.run.controller->last_state, "fault");
  ASSERT_EQ(read.run.controller->events.size(), 2u);
  EXPECT_EQ(read.run.controller->events[0].text, "state stand");
  EXPECT_EQ(read.run.controller->events[1].text, "state fault, faults stale_plan");
  EXPECT_NEAR(read.run.controller->events[1].time_s, 1.0, 1e-9);
}

TEST(BlackBoxRun, OfSeveralRunsTheLongestIsTaken) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("ticks.csv");
  const std::string shorter = ticks_text(supervisor::State::fault, 500), longer = ticks_text();
  const std::string header = shorter.substr(0, shorter.find('\n') + 1);
  const std::string short_ticks = shorter.substr(header.size()), long_ticks = longer.substr(header.size());
  std::ofstream(file) << header << long_ticks;
  const RecordRun alone = run_of_ticks(file, amber3m());
  EXPECT_EQ(alone.runs, 1u);
  const std::string orders[] = {short_ticks + long_ticks, long_ticks + short_ticks,
                                short_ticks + long_ticks + short_ticks,
                                long_ticks + short_ticks + short_ticks};
  for (const std::string& ticks : orders) {
    std::ofstream(file) << header << ticks;
    const RecordRun read = run_of_ticks(file, amber3m());
    EXPECT_EQ(read.runs, ticks.size() > orders[0].size() ? 3u : 2u);
    EXPECT_TRUE(read.problems.empty());
    EXPECT_EQ(read.run.samples.size(), alone.run.samples.size());
    EXPECT_EQ(read.run.summary.duration_s, alone.run.summary.duration_s);
    EXPECT_EQ(read.run.summary.distance_m, alone.run.summary.distance_m);
    EXPECT_EQ(read.run.controller->events.size(), alone.run.controller->events.size());
    EXPECT_EQ(read.run.controller->last_state, "fault");
    EXPECT_EQ(read.run.robot.name, "amber3m");
  }
}

TEST(BlackBoxRun, MissingTicksAreReported) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("ticks.csv");
  const std::string text = ticks_text();
  const auto from = text.find("\n7100,") + 1;
  std::ofstream(file) << text.substr(0, from) << text.substr(text.find("\n7200,") + 1);
  const RecordRun read = run_of_ticks(file, amber3m());
  ASSERT_EQ(read.problems.size(), 1u);
  EXPECT_EQ(read.problems[0], file + ": ticks 7000 to 8999, missing: 7100 to 7199; plots have a break there");
  ASSERT_EQ(read.run.missing_ticks.size(), 1u);
  EXPECT_EQ(read.run.missing_ticks[0].first, 7100u);
  EXPECT_EQ(read.runs, 1u);
}

TEST(BlackBoxRun, EveryStateIsRead) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("fault.csv");
  for (std::size_t i = 0; i < supervisor::kStates; ++i) {
    const auto state = static_cast<supervisor::State>(i);
    std::ofstream(file) << ticks_text(state);
    const RecordRun read = run_of_ticks(file, amber3m());
    EXPECT_TRUE(read.problems.empty()) << supervisor::name(state);
    const std::string& last = read.run.controller->events.back().text;
    EXPECT_TRUE(last.starts_with(std::string("state ") + supervisor::name(state))) << last;
  }
}

TEST(BlackBoxRun, WhatIsCutOffOrNoBlackBoxIsNamed) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("fault.csv"), text = ticks_text();
  std::ofstream(file) << text.substr(0, text.size() - 40);
  const RecordRun read = run_of_ticks(file, amber3m());
  ASSERT_EQ(read.problems.size(), 1u);
  EXPECT_EQ(read.problems[0], file + ": line 2001 is no tick of stiltd; the report ends before it");
  EXPECT_EQ(read.run.samples.size(), 400u);
  std::ofstream(file) << text.substr(0, text.find('\n') + 1);
  EXPECT_EQ(complaint_of(file, true), ": holds no tick; name a file of stiltd --black-box");
  std::ofstream(file) << "tick,time_s\n1,0\n";
  EXPECT_EQ(complaint_of(file, true),
            ": has no column state; name a file of stiltd --black-box or the ticks of stilt log csv");
}

}  // namespace
}  // namespace stilt::record
