// What pages command, and who of them is in command.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "silent_source.h"

namespace stilt::monitor {
namespace {

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

/// Every program of the domain may send replies.
TEST(LiveView, ARefusalWithoutProofIsShownAsOneAndTheRobotsOwnReplyStillCounts) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.received(*page, false, kWalk);
  view.step(0.0);
  const std::uint64_t commander = source.commands.at(0).commander;
  source.news = [commander](SampleSink& sink) {
    sink.reply({commander, 7, false, "the robot is tired", false});
    sink.reply({commander, 7, true, "", false});
  };
  view.step(0.1);
  view.step(0.2);
  auto replies = page->of_type("reply");
  ASSERT_EQ(replies.size(), 2u);
  for (const auto& reply : replies) {
    EXPECT_FALSE(reply["proven"]);
    EXPECT_FALSE(reply["accepted"]);
  }
  EXPECT_EQ(replies[0]["reason"], "the robot is tired");
  EXPECT_EQ(source.heartbeats(), 0) << "no page is accepted";
  source.answers = true;
  view.step(0.3);
  view.step(0.4);
  replies = page->of_type("reply");
  ASSERT_EQ(replies.size(), 3u);
  EXPECT_TRUE(replies[2]["proven"]);
  EXPECT_TRUE(replies[2]["accepted"]);
  EXPECT_EQ(source.heartbeats(), 1) << "the page is in command";
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
            "The sender's data were 4.0 s old when this order came, 0.5 s at most: look, then order again.");
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
       {"", "{", "[]", "7", R"({"command": "fly", "sequence": 1})", R"({"command": "off", "sequence": 1})",
        R"({"command": "walk"})", R"({"command": 5, "sequence": 1})",
        R"({"command": "walk", "sequence": -1e99})", R"({"command": "walk", "sequence": 4294967296})",
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

}  // namespace
}  // namespace stilt::monitor
