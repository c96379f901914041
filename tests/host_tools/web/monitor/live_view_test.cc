#include "host_tools/web/monitor/live_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <utility>

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
  EXPECT_EQ(hello["columns"]["ticks"][1], "estimated_state0");
}

TEST(LiveView, TheHeartbeatOfAPageInCommandGoesOnAsLongAsThePageLives) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.step(0.0);
  EXPECT_EQ(source.heartbeats(), 0) << "a page that only looks does not command";
  view.received(*page, false, kWalk);
  source.answers = true;
  view.step(0.2);
  for (int k = 1; k <= 20; ++k) {
    view.received(*page, false, R"({"alive": true})");
    view.step(0.2 + 0.1 * k);
  }
  const int lively = source.heartbeats();
  EXPECT_GE(lively, 19);
  for (int k = 1; k <= 20; ++k) view.step(2.2 + 0.1 * k);
  EXPECT_LE(source.heartbeats() - lively, 6) << "silent for longer than kPageSilence_s";
}

TEST(LiveView, AHeartbeatHasTheTokenOfThePagesCommand) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  view.opened(page);
  view.received(*page, false, R"({"command": "walk", "sequence": 7, "value": 0.5, "token": "of the page"})");
  source.answers = true;
  view.step(0.0);
  view.step(0.2);
  ASSERT_EQ(source.commands.back().kind, CommandKind::heartbeat);
  EXPECT_EQ(source.commands.back().token, "of the page");
  EXPECT_EQ(source.commands.back().commander, source.commands[0].commander);
}

TEST(LiveView, ARefusedCommandPutsNoPageInCommand) {
  SilentSource source;
  source.refusal = "the robot has fallen";
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.received(*page, false, kWalk);
  source.answers = true;
  view.step(0.0);
  view.step(0.2);
  EXPECT_EQ(source.heartbeats(), 0);
  EXPECT_EQ(page->of_type("reply").at(0)["reason"], "the robot has fallen");
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

TEST(LiveView, AClosedPageIsNotSpokenFor) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.received(*page, false, kWalk);
  view.step(0.0);
  source.answers = true;
  view.step(0.11);
  view.closed(*page);
  const int before = source.heartbeats();
  view.step(0.3);
  view.step(0.5);
  EXPECT_EQ(source.heartbeats(), before);
}

TEST(LiveView, ThePageWhoseCommandWasAcceptedLastIsInCommandAlone) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto first = std::make_shared<FakePeer>();
  const auto second = std::make_shared<FakePeer>();
  open_with_key(view, first);
  open_with_key(view, second);
  view.received(*first, false, kWalk);
  view.step(0.0);
  source.answers = true;
  view.step(0.01);
  view.received(*second, false, kWalk);
  view.step(0.02);
  source.answers = true;
  view.step(0.03);
  source.commands.clear();
  for (int k = 0; k < 5; ++k) {
    view.received(*first, false, R"({"alive": true})");
    view.step(0.6 + 0.11 * k);  // the second page is silent
  }
  EXPECT_EQ(source.heartbeats(), 0);
}

TEST(LiveView, OrdersOfAPageWhoseDataAreOldAreRefusedButStopAndCut) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.step(7.0);
  const double link_time_s = page->of_type("link").back()["time_s"];
  EXPECT_EQ(link_time_s, 7.0);
  int sequence = 0;
  const auto passed_on = [&](const char* command, double now_s) {
    nlohmann::json order = {{"command", command}, {"sequence", ++sequence}, {"link_time_s", link_time_s}};
    source.commands.clear();
    view.received(*page, false, order.dump());
    view.step(now_s);
    return std::ranges::any_of(source.commands, [&](const Command& one) {
      return std::string(command) == telemetry::name(one.kind);
    });
  };
  const char* const orders[] = {"stand", "step", "walk", "speed", "height", "sit", "reset", "tunable"};
  for (const char* const order : orders) EXPECT_TRUE(passed_on(order, 7.5)) << order;
  EXPECT_TRUE(page->of_type("reply").empty());
  for (const char* const order : orders) EXPECT_FALSE(passed_on(order, 11.0)) << order;
  const auto replies = page->of_type("reply");
  ASSERT_EQ(replies.size(), std::size(orders));
  EXPECT_EQ(replies[0]["reason"],
            "The page's data were 4.0 s old when this order came, 0.5 s at most: look, then order again.");
  EXPECT_TRUE(passed_on("stop", 11.0));
  EXPECT_TRUE(passed_on("cut", 11.0));
}

TEST(LiveView, AnOrderWithoutTheTimeOfALinkMessageIsTaken) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.step(0.0);
  view.received(*page, false, kWalk);
  view.step(100.0);
  EXPECT_EQ(source.commands.at(0).kind, CommandKind::walk);
}

/// Two pages; the first walks the robot, the second changes the height of its hip.
struct WalkAndHeight {
  WalkAndHeight() {
    open_with_key(view, walks);
    open_with_key(view, changes);
    order(0.0, *walks, kWalk);
    order(0.02, *changes, R"({"command": "height", "sequence": 1, "value": 0.78})");
    source.commands.clear();
  }
  void order(double now_s, FakePeer& page, const char* text) {
    view.received(page, false, text);
    view.step(now_s);
    source.answers = true;
    view.step(now_s + 0.01);
  }
  /// Of half a second in which `alive` gives signs of life.
  int heartbeats(FakePeer& alive) {
    for (int k = 0; k <= 5; ++k) {
      view.received(alive, false, R"({"alive": true})");
      view.step(0.6 + 0.11 * k);
    }
    return source.heartbeats();
  }

  SilentSource source;
  LiveView view{source, kKey};
  std::shared_ptr<FakePeer> walks = std::make_shared<FakePeer>(), changes = std::make_shared<FakePeer>();
};

TEST(LiveView, APageThatChangesTheHeightLeavesTheHeartbeatToThePageThatWalks) {
  WalkAndHeight both;
  both.view.closed(*both.changes);
  EXPECT_EQ(both.heartbeats(*both.walks), 5);
}

TEST(LiveView, APageThatChangedTheHeightIsNotSpokenForWhenThePageThatWalksIsGone) {
  WalkAndHeight both;
  both.view.closed(*both.walks);
  EXPECT_EQ(both.heartbeats(*both.changes), 0);
}

TEST(LiveView, WhatIsNoMessageOfThePageIsRefusedAndTheViewGoesOn) {
  for (const char* text :
       {"", "{", "[]", "7", R"({"command": "fly", "sequence": 1})",
        R"({"command": "off", "sequence": 1})", R"({"command": "walk"})", R"({"command": 5, "sequence": 1})", R"({"command": "walk", "sequence": -1e99})",
        R"({"command": "walk", "sequence": 4294967296})",
        R"({"command": "walk", "sequence": 1, "value": 1e999})", R"({"command": "walk", "sequence": 1.5})",
        R"({"command": "walk", "sequence": 1, "token": 7})",
        R"({"command": "walk", "sequence": 1, "link_time_s": "now"})",
        R"({"command": "walk", "sequence": 1, "value": "fast"})", "\xff\xfe"}) {
    SilentSource source;
    LiveView view(source, kKey);
    const auto page = std::make_shared<FakePeer>();
    open_with_key(view, page);
    view.received(*page, false, text);
    view.step(0.0);
    EXPECT_TRUE(source.commands.empty()) << text;
    const auto replies = page->of_type("reply");
    ASSERT_EQ(replies.size(), 1u) << text;
    EXPECT_FALSE(replies[0]["accepted"]) << text;
  }
}

TEST(LiveView, EveryCommandGoesOnWithItsNumbers) {
  const std::pair<const char*, CommandKind> kinds[] = {
      {"stand", CommandKind::stand},     {"step", CommandKind::step},
      {"walk", CommandKind::walk},       {"speed", CommandKind::speed},
      {"height", CommandKind::height},   {"sit", CommandKind::sit},
      {"stop", CommandKind::stop},       {"reset", CommandKind::reset},
      {"tunable", CommandKind::tunable}, {"heartbeat", CommandKind::heartbeat}};
  for (const auto& [text, kind] : kinds) {
    SilentSource source;
    LiveView view(source, kKey);
    const auto page = std::make_shared<FakePeer>();
    open_with_key(view, page);
    view.received(*page, false,
                  std::string(R"({"command": ")") + text +
                      R"(", "sequence": 4294967295, "value": -0.25, "tunable": "cost.base_z"})");
    view.step(0.0);
    ASSERT_EQ(source.commands.size(), 1u) << text;
    EXPECT_EQ(source.commands[0].kind, kind);
    EXPECT_EQ(source.commands[0].sequence, 4294967295u);
    EXPECT_EQ(source.commands[0].value, -0.25);
    EXPECT_EQ(source.commands[0].tunable, "cost.base_z");
    EXPECT_NE(source.commands[0].commander, 0u);
  }
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
