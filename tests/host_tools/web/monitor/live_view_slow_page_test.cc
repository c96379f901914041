// What a page gets, and may do, whose network is slower than the data.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "silent_source.h"
#include "synthetic_source.h"

namespace stilt::monitor {
namespace {

/// A sign of life of a page whose newest link message is of that time.
std::string alive(double link_time_s) {
  return nlohmann::json{{"alive", true}, {"link_time_s", link_time_s}}.dump();
}

auto tables_of(const FakePeer& page) {
  return std::ranges::count_if(page.messages, [](const SharedMessage& message) { return message->binary; });
}

void one_tick_and_one_event(SampleSink& sink) {
  sink.tick({});
  sink.event({});
}

TEST(SlowPage, IsNotSpokenForWhileItsDataAreOldAlthoughItIsAlive) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.received(*page, false, kWalk);
  view.step(0.0);
  source.answers = true;
  view.step(0.1);
  const auto heartbeats_from = [&](double start_s, double link_age_s) {
    source.commands.clear();
    for (int k = 0; k < 10; ++k) {
      const double now_s = start_s + 0.1 * k;
      view.received(*page, false, alive(now_s - link_age_s));
      view.step(now_s);
    }
    return source.heartbeats();
  };
  EXPECT_GE(heartbeats_from(0.2, 0.1), 9);
  EXPECT_LE(heartbeats_from(1.2, 4.0), 1) << "the one before the first of these signs of life";
  EXPECT_GE(heartbeats_from(2.2, 0.4), 8) << "it has caught up";
}

TEST(SlowPage, GetsNoTablesUntilItHasCaughtUpAndEveryOtherMessage) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto slow = std::make_shared<FakePeer>(), other = std::make_shared<FakePeer>();
  view.opened(slow);
  view.opened(other);
  view.step(0.0);
  const auto step = [&](double now_s, double link_time_s) {
    view.received(*slow, false, alive(link_time_s));
    source.news = one_tick_and_one_event;
    view.step(now_s);
  };
  step(4.0, 3.75);
  EXPECT_EQ(tables_of(*slow), 1) << "up to kCatchUp_s behind it gets all";
  step(5.0, 4.5);
  EXPECT_EQ(tables_of(*slow), 1);
  EXPECT_EQ(slow->of_type("event").size(), 2u);
  EXPECT_EQ(slow->of_type("link").back()["behind_s"], 0.5);
  EXPECT_EQ(slow->of_type("link").back()["not_sent"], 1);
  step(6.0, 5.75);
  EXPECT_EQ(tables_of(*slow), 2);
  EXPECT_EQ(slow->of_type("link").back()["behind_s"], 0.25);
  EXPECT_EQ(slow->of_type("link").back()["not_sent"], 1) << "so far";
  EXPECT_EQ(tables_of(*other), 3) << "a program that returns no time counts as up to date";
  EXPECT_EQ(other->of_type("link").back()["behind_s"], 0.0);
}

TEST(SlowPage, HasOpenedWhenTheTimeToDrawItselfIsOver) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  view.opened(page);
  view.step(0.0);
  view.received(*page, false, alive(0.0));
  source.news = one_tick_and_one_event;
  view.step(1.0);
  EXPECT_EQ(tables_of(*page), 1);
}

TEST(SlowPage, GetsATimeToReturnBeforeTheHistory) {
  SyntheticSource source;
  LiveView view(source, kKey);
  for (int k = 0; k <= 20; ++k) {
    source.advance(0.1 * k);
    view.step(0.1 * k);
  }
  const auto page = std::make_shared<FakePeer>();
  view.opened(page);
  view.step(3.0);
  EXPECT_GT(tables_of(*page), 0);
  const auto second = nlohmann::json::parse(page->messages.at(1)->bytes);
  EXPECT_EQ(second["type"], "link");
  EXPECT_EQ(second["time_s"], 3.0);
}

}  // namespace
}  // namespace stilt::monitor
