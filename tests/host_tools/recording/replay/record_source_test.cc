#include "host_tools/recording/replay/record_source.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "firmware/robots/robots.h"
#include "host_tools/recording/record/recorder.h"
#include "host_tools/web/monitor/page_messages.h"
#include "tests/host_tools/recording/mcap/sample_file.h"
#include "tests/host_tools/recording/record_sample.h"

namespace stilt::replay {
namespace {

/// Keeps what comes.
class Sink final : public monitor::SampleSink {
 public:
  std::vector<monitor::ConfigurationSample> configurations;
  std::vector<monitor::TickSample> ticks;
  std::vector<monitor::EventSample> events;
  std::vector<monitor::ReplySample> replies;

  void configuration(const monitor::ConfigurationSample& sample) override {
    configurations.push_back(sample);
  }
  void tick(const monitor::TickSample& sample) override { ticks.push_back(sample); }
  void plan(const monitor::PlanSample&) override {}
  void planner(const monitor::PlannerSample&) override {}
  void supervisor(const monitor::SupervisorSample&) override {}
  void event(const monitor::EventSample& sample) override { events.push_back(sample); }
  void timing(const monitor::TimingSample&) override {}
  void truth(const monitor::TruthSample&) override {}
  void reply(const monitor::ReplySample& sample) override { replies.push_back(sample); }
};

/// A record made in no time, as in lock-step.
std::string write_record(const std::string& path) {
  record::Recorder recorder(path, {});
  recorder.take(record::configuration_sample(7, ""), 1);
  for (std::uint64_t first = 0; first < 100; first += 20) {
    recorder.take(record::ticks_sample(7, first, 20), 2);
    if (first == 40) recorder.take(record::event_sample(7, "the robot walks"), 2);
  }
  return path;
}

class RecordSourceTest : public testing::Test {
 protected:
  /// What has come after so many milliseconds of playing.
  const Sink& after(int time_ms) {
    now = RecordSource::Clock::time_point(std::chrono::milliseconds(time_ms));
    source.poll(sink);
    return sink;
  }

  mcap::TemporaryFile file{"source"};
  RecordSource::Clock::time_point now{};
  RecordSource source{write_record(file.path()), [this] { return now; }};
  Sink sink;
};

TEST_F(RecordSourceTest, PlaysByTheClockOfTheTorqueLoop) {
  EXPECT_EQ(after(0).configurations.size(), 1u);
  EXPECT_EQ(sink.ticks.size(), 20u);
  EXPECT_EQ(after(19).ticks.size(), 20u);
  EXPECT_EQ(after(21).ticks.size(), 40u);
  EXPECT_TRUE(sink.events.empty());
  EXPECT_EQ(after(41).ticks.size(), 60u);
  EXPECT_EQ(sink.events.size(), 1u) << "with the ticks before it";
  EXPECT_EQ(after(1000).ticks.size(), 100u);
  EXPECT_EQ(after(2000).ticks.size(), 100u) << "once";
}

TEST_F(RecordSourceTest, PlaysAgainFromItsStart) {
  after(0);
  ASSERT_EQ(after(1000).ticks.size(), 100u);
  source.play_from(0.0);
  EXPECT_EQ(after(1500).ticks.size(), 120u) << "the first batch at once";
  EXPECT_EQ(sink.ticks[100].record.tick, 0u);
  EXPECT_EQ(sink.configurations.size(), 2u);
  EXPECT_EQ(after(1521).ticks.size(), 140u);
  EXPECT_EQ(after(3000).ticks.size(), 200u);
}

TEST_F(RecordSourceTest, StandsStillWhileItIsHeld) {
  after(0);
  ASSERT_EQ(after(21).ticks.size(), 40u);
  source.hold(true);
  EXPECT_EQ(after(5000).ticks.size(), 40u);
  EXPECT_TRUE(source.playback()->held);
  source.hold(false);
  EXPECT_EQ(after(5015).ticks.size(), 40u);
  EXPECT_EQ(after(5021).ticks.size(), 60u);
}

TEST_F(RecordSourceTest, SaysWhereItIs) {
  after(0);
  after(30);
  EXPECT_NEAR(source.playback()->at_s, 0.030, 1e-9);
  EXPECT_NEAR(source.playback()->length_s, 0.080, 1e-9) << "first to last batch";
  after(4000);
  EXPECT_EQ(source.playback()->at_s, source.playback()->length_s);
}

TEST_F(RecordSourceTest, ATimeOutsideTheRecordIsItsStartOrItsEnd) {
  source.play_from(-3.0);
  EXPECT_EQ(after(0).ticks.size(), 20u);
  source.play_from(1e9);
  EXPECT_EQ(after(1).ticks.size(), 120u);
}

TEST_F(RecordSourceTest, TicksKeepTheirNumbers) {
  after(0);
  ASSERT_EQ(after(1000).ticks.size(), 100u);
  for (std::size_t i = 0; i < sink.ticks.size(); ++i) EXPECT_EQ(sink.ticks[i].record.tick, i);
}

TEST_F(RecordSourceTest, TakesNoCommandsAndSaysSo) {
  EXPECT_FALSE(source.live());
  monitor::Command walk;
  walk.kind = monitor::CommandKind::walk;
  walk.commander = 3;
  walk.sequence = 9;
  source.command(walk);
  monitor::Command heartbeat = walk;
  heartbeat.kind = monitor::CommandKind::heartbeat;
  heartbeat.sequence = 10;
  source.command(heartbeat);
  ASSERT_EQ(after(0).replies.size(), 1u);
  EXPECT_FALSE(sink.replies[0].accepted);
  EXPECT_EQ(sink.replies[0].commander, 3u);
  EXPECT_EQ(sink.replies[0].sequence, 9u);
  EXPECT_EQ(after(1).replies.size(), 1u);
}

/// A run of 20 s, with an event in its 3rd and its 15th second.
TEST(RecordSource, PlaysFromTheMiddleWithWhatIsStillTrue) {
  const mcap::TemporaryFile file("middle");
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(record::configuration_sample(7, ""), 1);
    for (std::uint64_t first = 0; first < 20'000; first += 20) {
      recorder.take(record::ticks_sample(7, first, 20), 2);
      if (first == 3000) recorder.take(record::event_sample(7, "the robot walks"), 2);
      if (first == 15'000) recorder.take(record::event_sample(7, "the robot falls"), 2);
    }
  }
  RecordSource::Clock::time_point now{};
  RecordSource source{file.path(), [&now] { return now; }};
  Sink sink;
  const auto tick_s = [](const monitor::TickSample& tick) {
    return 1e-3 * static_cast<double>(tick.record.tick);
  };
  source.poll(sink);
  source.hold(true);
  sink = {};
  source.play_from(12.0);
  source.poll(sink);
  EXPECT_EQ(sink.configurations.size(), 1u);
  ASSERT_EQ(sink.events.size(), 1u);
  EXPECT_NE(sink.events[0].text.find("walks"), std::string::npos);
  ASSERT_FALSE(sink.ticks.empty());
  EXPECT_NEAR(tick_s(sink.ticks.front()), 12.0 - RecordSource::kBefore_s, 0.03);
  EXPECT_NEAR(tick_s(sink.ticks.back()), 12.0, 0.03);
  source.hold(false);
  now += std::chrono::seconds(4);
  source.poll(sink);
  EXPECT_NEAR(tick_s(sink.ticks.back()), 16.0, 0.03);
  EXPECT_EQ(sink.events.size(), 2u);
}

TEST(RecordSource, ARecordOfRelease01IsRefusedAtOnce) {
  const mcap::TemporaryFile file("first");
  record::write_record_of_0_1(file.path());
  EXPECT_THROW(RecordSource{file.path()}, std::runtime_error);
}

TEST(RecordSource, TheRobotIsTheOneThatWasRun) {
  const mcap::TemporaryFile file("robot");
  const std::string robot = file.path() + ".urdf";
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(record::configuration_sample(7, "", telemetry::kWireVersion, robot, 0, record::long_urdf()),
                  1);
    recorder.take(record::ticks_sample(7, 0, 20), 2);
  }
  EXPECT_FALSE(robots::find(robot)) << "the test is of a robot that is not there";
  RecordSource source{file.path()};
  EXPECT_TRUE(source.problems().empty());
  Sink sink;
  source.poll(sink);
  ASSERT_EQ(sink.configurations.size(), 1u);
  const auto message = nlohmann::json::parse(monitor::configuration_message(sink.configurations[0])->bytes);
  EXPECT_EQ(message.at("robot"), robot);
  EXPECT_EQ(message.at("drawing").at("thigh_length_m"), record::kLongThigh_m);
  EXPECT_TRUE(message.at("drawn_instead").is_null());
  sink.configurations[0].robot = "elsewhere.urdf";
  EXPECT_EQ(nlohmann::json::parse(monitor::configuration_message(sink.configurations[0])->bytes)
                .at("drawn_instead"),
            "amber3m");
}

TEST(RecordSource, ARecordThatWasCutOffIsPlayedAndThatIsReported) {
  mcap::TemporaryFile file("cut");
  write_record(file.path());
  mcap::Bytes bytes = file.bytes();
  bytes.erase(bytes.end() - 100, bytes.end());
  file.set_bytes(bytes);
  EXPECT_EQ(RecordSource{file.path()}.problems().size(), 1u);
}

TEST(RecordSource, ARecordWithoutTicksIsRefused) {
  const mcap::TemporaryFile file("empty");
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(record::configuration_sample(7, ""), 1);
  }
  EXPECT_THROW(RecordSource{file.path()}, std::runtime_error);
}

/// Ticks 0 to 19, 5000 to 5019, and 0 to 19 of another run, whose clock begins anew.
TEST(RecordSource, HolesAndOtherRunsTakeHalfASecondAtMost) {
  const mcap::TemporaryFile file("holes");
  {
    record::Recorder recorder(file.path(), {});
    recorder.take(record::configuration_sample(7, ""), 1);
    recorder.take(record::ticks_sample(7, 0, 20), 2);
    recorder.take(record::ticks_sample(7, 5000, 20), 2);
    recorder.take(record::ticks_sample(7, 0, 20), 2);
    recorder.take(record::ticks_sample(7, 20, 20), 2);
  }
  RecordSource::Clock::time_point now{};
  RecordSource source{file.path(), [&now] { return now; }};
  Sink sink;
  const auto ticks_after = [&](int time_ms) {
    now = RecordSource::Clock::time_point(std::chrono::milliseconds(time_ms));
    source.poll(sink);
    return sink.ticks.size();
  };
  EXPECT_EQ(ticks_after(0), 20u);
  EXPECT_EQ(ticks_after(499), 20u);
  EXPECT_EQ(ticks_after(501), 60u) << "the other run at once";
  EXPECT_EQ(ticks_after(519), 60u);
  EXPECT_EQ(ticks_after(521), 80u);
}

}  // namespace
}  // namespace stilt::replay
