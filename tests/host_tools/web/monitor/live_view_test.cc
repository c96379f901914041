#include "host_tools/web/monitor/live_view.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/state.h"
#include "silent_source.h"
#include "synthetic_source.h"

namespace stilt::monitor {
namespace {

TEST(LiveView, APageIsGreetedWithTheSupervisorsTables) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.step(0.0);
  const auto hello = page->of_type("hello").at(0);
  EXPECT_EQ(hello["faults"].size(), supervisor::kFaults);
  EXPECT_EQ(hello["states"].size(), supervisor::kStates);
  for (const auto& state : hello["states"]) {
    EXPECT_EQ(state["refused"].contains("height"), state["name"] == "watch" || state["name"] == "off")
        << state;
  }
  EXPECT_EQ(hello["columns"]["ticks"][1], "estimated_state0");
}

TEST(LiveView, AnotherRunTakesTheCommandFromThePageAndBeginsItsTicksAnew) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.received(*page, false, kWalk);
  source.answers = true;
  const auto begin = [](const char* run_id, std::uint64_t tick) {
    return [=](SampleSink& sink) {
      ConfigurationSample configuration;
      configuration.run_id = run_id;
      sink.configuration(configuration);
      TickSample sample;
      sample.record.tick = tick;
      sample.record.emergency_stop = hal::EmergencyStopState::pressed;
      sink.tick(sample);
    };
  };
  source.news = begin("1", 5);
  view.step(0.0);
  view.received(*page, false, kWalk);
  source.answers = true;
  view.step(0.2);
  view.step(0.29);
  ASSERT_EQ(source.heartbeats(), 1) << "in command";
  source.news = begin("2", 100);
  view.step(0.3);
  view.received(*page, false, R"({"alive": true})");
  view.step(0.5);
  EXPECT_EQ(source.heartbeats(), 1);
  EXPECT_EQ(page->of_type("link").back()["missing"], 0);
  EXPECT_EQ(page->of_type("link").back()["emergency_stop"], "pressed");
}

TEST(LiveView, OnlyThePageInCommandShowsAnotherRun) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto commands = std::make_shared<FakePeer>();
  const auto looks = std::make_shared<FakePeer>();
  open_with_key(view, commands);
  open_with_key(view, looks);
  view.received(*looks, false, R"({"run": "1"})");
  view.step(0.0);
  EXPECT_EQ(source.chosen, "1") << "no page commands";
  view.received(*commands, false, kWalk);
  source.answers = true;
  view.step(0.1);
  view.step(0.2);
  view.received(*looks, false, R"({"run": "2"})");
  view.step(0.3);
  EXPECT_EQ(source.chosen, "1");
  EXPECT_EQ(looks->of_type("reply").at(0)["reason"], "Another page commands the robot that is shown.");
  view.received(*commands, false, R"({"run": "3"})");
  view.step(0.4);
  EXPECT_EQ(source.chosen, "3");
}

TEST(LiveView, ThePageIsSentWhyAControllerCannotBeShown) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  view.opened(page);
  view.step(0.0);
  EXPECT_EQ(page->of_type("link").back()["refused"], "");
  source.unreadable = "run 7 has other messages";
  view.step(0.2);
  EXPECT_EQ(page->of_type("link").back()["refused"], "run 7 has other messages");
  EXPECT_EQ(page->of_type("link").back()["received"], false);
}

TEST(LiveView, AGapInTheTicksIsCounted) {
  SyntheticSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  source.advance(0.0);
  view.step(0.0);
  source.advance(0.1);
  view.step(0.1);
  source.change("drop 17");
  source.advance(0.3);
  view.step(0.3);
  EXPECT_EQ(page->of_type("link").back()["missing"], 17);
}

std::uint32_t rows_of_ticks(const FakePeer& page) {
  std::uint32_t ticks = 0;
  for (const SharedMessage& message : page.messages) {
    if (!message->binary || message->bytes[0] != static_cast<char>(Table::ticks)) continue;
    std::uint32_t rows = 0;
    std::memcpy(&rows, message->bytes.data() + 4, sizeof rows);
    ticks += rows;
  }
  return ticks;
}

TEST(LiveView, APageThatOpensLaterGetsTheLastSeconds) {
  SyntheticSource source;
  LiveView view(source, kKey);
  for (int k = 0; k <= 50; ++k) {
    source.advance(0.1 * k);
    view.step(0.1 * k);
  }
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.step(5.01);
  EXPECT_EQ(rows_of_ticks(*page), 5000u);
  EXPECT_EQ(page->of_type("configuration").size(), 1u);
  EXPECT_EQ(page->of_type("supervisor").size(), 1u);
}

TEST(LiveView, APageThatOpensLaterGetsNoMoreThanTheLastTwelveSeconds) {
  SyntheticSource source;
  LiveView view(source, kKey);
  for (int k = 0; k <= 200; ++k) {
    source.advance(0.1 * k);
    view.step(0.1 * k);
  }
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.step(20.0);
  EXPECT_NEAR(rows_of_ticks(*page), 12'000, 200);
}

TEST(LiveView, AnotherRunLeavesNothingOfTheOneBefore) {
  SyntheticSource source;
  LiveView view(source, kKey);
  source.advance(0.0);
  view.step(0.0);
  source.advance(1.0);
  view.step(1.0);
  source.change("run");
  view.step(1.01);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.step(1.02);
  EXPECT_EQ(page->of_type("configuration").at(0)["run_id"], "synthetic-2");
  for (const SharedMessage& message : page->messages) EXPECT_FALSE(message->binary);
  EXPECT_TRUE(page->of_type("supervisor").empty());
  EXPECT_TRUE(page->of_type("event").empty());
}

TEST(LiveView, ARecordTakesNoCommands) {
  SyntheticSource source;
  source.change("record");
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.received(*page, false, kWalk);
  view.step(0.0);
  EXPECT_FALSE(page->of_type("reply").at(0)["accepted"]);
}

/// A source that counts what is asked of a record.
class Record final : public SampleSource {
 public:
  void poll(SampleSink& sink) override {
    if (polls++ > 0) return;
    ConfigurationSample sample;
    sample.run_id = "7";
    sink.configuration(sample);
    sink.event({});
  }
  void command(const Command&) override {}
  void play_from(double from_s) override {
    polls = 0;
    at = {.at_s = from_s, .length_s = 60.0};
  }
  void hold(bool held) override { at.held = held; }
  [[nodiscard]] std::optional<Playback> playback() const override { return at; }
  [[nodiscard]] std::string describe() const override { return "walk.mcap"; }
  [[nodiscard]] bool live() const override { return is_live; }
  int polls = 0;
  bool is_live = false;
  Playback at;
};

TEST(LiveView, ARecordWaitsForItsFirstPage) {
  Record source;
  LiveView view(source, kKey);
  view.step(0.0);
  EXPECT_EQ(source.polls, 0);
  open_with_key(view, std::make_shared<FakePeer>());
  view.step(0.1);
  EXPECT_EQ(source.polls, 1);
}

/// A record on two pages.
struct RecordOnTwoPages {
  RecordOnTwoPages() {
    for (const auto& page : pages) open_with_key(view, page);
    view.step(0.0);
  }

  Record source;
  LiveView view{source, kKey};
  std::array<std::shared_ptr<FakePeer>, 2> pages{std::make_shared<FakePeer>(), std::make_shared<FakePeer>()};
};

TEST(LiveView, ARecordPlayedFromAnotherTimeBeginsAnewOnEveryPage) {
  RecordOnTwoPages record;
  record.view.received(*record.pages[0], false, R"({"from": 12.5})");
  record.view.step(0.1);
  for (const auto& page : record.pages) {
    EXPECT_EQ(page->of_type("hello").size(), 2u);
    EXPECT_EQ(page->of_type("configuration").size(), 2u);
  }
  EXPECT_EQ(record.source.at.at_s, 12.5);
  const auto third = std::make_shared<FakePeer>();
  open_with_key(record.view, third);
  record.view.step(0.2);
  EXPECT_EQ(third->of_type("event").size(), 1u) << "of this time alone";
}

TEST(LiveView, ARecordThatIsHeldIsHeldOnEveryPageAtOnce) {
  RecordOnTwoPages record;
  for (const bool held : {true, false}) {
    record.view.received(*record.pages[1], false, held ? R"({"hold": true})" : R"({"hold": false})");
    record.view.step(0.001);
    EXPECT_EQ(record.source.at.held, held);
    for (const auto& page : record.pages) {
      EXPECT_EQ(page->of_type("link").back()["playback"]["held"], held);
    }
  }
}

TEST(LiveView, ALiveSourceIsNeitherHeldNorPlayedFromAnotherTime) {
  RecordOnTwoPages record;
  record.source.is_live = true;
  record.view.received(*record.pages[0], false, R"({"from": 3, "hold": true})");
  record.view.step(0.1);
  EXPECT_EQ(record.source.at.at_s, 0.0);
  EXPECT_FALSE(record.source.at.held);
}

}  // namespace
}  // namespace stilt::monitor
