// What a page may do with and without the key and tokens.
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>

#include "silent_source.h"

namespace stilt::monitor {
namespace {

TEST(LiveView, WithoutKeyOrTokenAPageCommandsNothingWhereverItIs) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  view.opened(page);
  for (const char* key : {"", "0123456789abcde", "0123456789abcdeF", "0123456789abcdef0"}) {
    view.received(*page, false, std::string(R"({"key": ")") + key + "\"}");
    view.received(*page, false, kWalk);
  }
  view.received(*page, false, R"({"run": "other"})");
  view.received(*page, false, R"({"new_key": true})");
  view.step(0.0);
  EXPECT_TRUE(source.commands.empty());
  EXPECT_TRUE(source.chosen.empty()) << "nor does it show another robot to the page that commands";
  EXPECT_FALSE(page->held);
  for (const auto& access : page->of_type("access")) {
    EXPECT_FALSE(access["has_key"]);
    EXPECT_EQ(access["key"], "");
    EXPECT_TRUE(access["urls"].empty());
  }
  const auto replies = page->of_type("reply");
  ASSERT_EQ(replies.size(), 5u);
  for (const auto& reply : replies) EXPECT_FALSE(reply["accepted"]);
  EXPECT_NE(replies[0]["reason"].get<std::string>().find("link that stilt monitor printed"),
            std::string::npos);
  view.received(*page, false, R"({"command": "walk", "sequence": 8, "value": 0.5, "token": "t"})");
  view.step(0.1);
  ASSERT_EQ(source.commands.size(), 1u);
  EXPECT_EQ(source.commands[0].token, "t");
  EXPECT_FALSE(source.commands[0].with_known_tokens);
}

TEST(LiveView, APageWithTheKeyCommandsAndKnowsTheLinksForOtherMachines) {
  SilentSource source;
  LiveView view(source, kKey);
  view.set_urls({"http://10.0.0.7:8080/"});
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.received(*page, false, kWalk);
  view.step(0.0);
  ASSERT_EQ(source.commands.size(), 1u);
  EXPECT_TRUE(source.commands[0].with_known_tokens);
  EXPECT_TRUE(page->held);
  const auto access = page->of_type("access").back();
  EXPECT_TRUE(access["has_key"]);
  EXPECT_TRUE(access["has_token"]);
  EXPECT_EQ(access["key"], kKey);
  EXPECT_EQ(access["urls"], nlohmann::json({"http://10.0.0.7:8080/"}));
}

TEST(LiveView, ANewKeyEndsWhatEveryOtherPageMayDo) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto owner = std::make_shared<FakePeer>(), lost_phone = std::make_shared<FakePeer>();
  open_with_key(view, owner);
  open_with_key(view, lost_phone);
  view.received(*lost_phone, false, kWalk);
  view.step(0.0);
  source.answers = true;
  view.step(0.1);
  view.step(0.19);
  ASSERT_EQ(source.heartbeats(), 1) << "in command";
  view.received(*owner, false, R"({"new_key": true})");
  view.step(0.2);
  source.commands.clear();
  for (int k = 1; k <= 5; ++k) {
    view.received(*lost_phone, false, kWalk);
    view.received(*lost_phone, false, std::string(R"({"key": ")") + kKey + "\"}");
    view.step(0.2 + 0.1 * k);
  }
  EXPECT_TRUE(source.commands.empty()) << "neither commands nor heartbeats";
  EXPECT_FALSE(lost_phone->held);
  EXPECT_FALSE(lost_phone->of_type("access").back()["has_key"]);
  const auto access = owner->of_type("access").back();
  EXPECT_TRUE(access["has_key"]);
  EXPECT_NE(access["key"], kKey);
  view.received(*owner, false, kWalk);
  view.step(1.0);
  EXPECT_EQ(source.commands.size(), 1u);
}

/// A page in command, and another that would show another run.
struct CommandsAndLooks {
  CommandsAndLooks() {
    open_with_key(view, commands);
    open_with_key(view, looks);
    view.received(*commands, false, kWalk);
    view.step(0.0);
    source.answers = true;
    view.step(0.1);
    view.received(*looks, false, R"({"run": "refused"})");
    view.step(0.2);
  }

  SilentSource source;
  LiveView view{source, kKey};
  std::shared_ptr<FakePeer> commands = std::make_shared<FakePeer>(), looks = std::make_shared<FakePeer>();
};

TEST(LiveView, APageInCommandThatIsSilentKeepsNoOtherFromShowingAnotherRun) {
  CommandsAndLooks both;
  EXPECT_EQ(both.source.chosen, "") << "it gave a sign of life 0.2 s ago";
  both.view.received(*both.looks, false, R"({"run": "other"})");
  both.view.step(0.6);
  EXPECT_EQ(both.source.chosen, "other");
}

TEST(LiveView, APageInCommandThatGivesAnotherKeyKeepsNoOtherFromShowingAnotherRun) {
  CommandsAndLooks both;
  both.view.received(*both.commands, false, R"({"key": "none"})");
  both.view.step(0.3);
  const int before = both.source.heartbeats();
  both.view.received(*both.looks, false, R"({"run": "other"})");
  both.view.step(0.4);
  EXPECT_EQ(both.source.chosen, "other");
  EXPECT_EQ(both.source.heartbeats(), before);
}

TEST(LiveView, APageInCommandWhoseLinkWasTakenBackCommandsNoMoreAlsoWithTheNextLink) {
  CommandsAndLooks both;
  EXPECT_EQ(both.source.chosen, "");
  both.view.received(*both.looks, false, R"({"new_key": true})");
  both.view.received(*both.commands, false, R"({"alive": true})");
  both.view.step(0.3);
  both.view.received(*both.looks, false, R"({"run": "other"})");
  both.view.received(*both.commands, false, R"({"alive": true})");
  both.view.step(0.4);
  EXPECT_EQ(both.source.chosen, "other");
  const std::string key = both.looks->of_type("access").back()["key"];
  both.view.received(*both.commands, false, R"({"key": ")" + key + "\"}");
  both.view.step(0.5);
  ASSERT_TRUE(both.commands->of_type("access").back()["has_key"]);
  const int before = both.source.heartbeats();
  both.view.step(0.6);
  both.view.step(0.7);
  EXPECT_EQ(both.source.heartbeats(), before) << "before it gives another order";
}

TEST(LiveView, StopCarriesTheTokensOfOtherRuns) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  view.opened(page);
  view.received(
      *page, false,
      R"({"command": "stop", "sequence": 1, "token": "a", "tokens": {"run a": "a", "run b": "b"}})");
  view.step(0.0);
  ASSERT_EQ(source.commands.size(), 1u);
  EXPECT_EQ(source.commands[0].tokens_of_others,
            (std::map<std::string, std::string>{{"run a", "a"}, {"run b", "b"}}));
}

/// A walk with a token of the page, whose command has this number.
std::string walk_with_token(int sequence, const std::string& token) {
  return R"({"command": "walk", "sequence": )" + std::to_string(sequence) + R"(, "token": ")" + token +
         R"("})";
}

TEST(LiveView, AHeartbeatHasTheTokenOfTheCommandThatWasAcceptedAndNotOfTheNewest) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  view.opened(page);
  view.received(*page, false, walk_with_token(1, "right"));
  view.received(*page, false, walk_with_token(2, "wrong"));
  view.step(0.0);
  const std::uint64_t commander = source.commands.at(0).commander;
  source.news = [commander](SampleSink& sink) { sink.reply({commander, 1, true, ""}); };
  view.step(0.2);
  view.step(0.4);
  ASSERT_EQ(source.heartbeats(), 1);
  EXPECT_EQ(source.commands.back().token, "right");
}

TEST(LiveView, AStopWithAWrongTokenOfAPageWithTheKeyLeavesTheHeartbeatItsToken) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.received(*page, false, kWalk);
  view.step(0.0);
  source.answers = true;
  view.step(0.1);
  view.received(*page, false, R"({"command": "stop", "sequence": 8, "token": "a guess"})");
  view.step(0.15);
  EXPECT_TRUE(source.commands.back().with_known_tokens);
  source.answers = true;
  view.step(0.2);
  view.step(0.3);
  ASSERT_EQ(source.commands.back().kind, CommandKind::heartbeat);
  EXPECT_EQ(source.commands.back().token, "");
}

TEST(LiveView, AReplyCountsOnceAndOnlyForACommandThatWasAsked) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  view.opened(page);
  const int most = static_cast<int>(LiveView::kAskedAtMost);
  for (int k = 1; k <= most + 1; ++k) {
    view.received(*page, false, walk_with_token(k, "of the page"));
    view.step(0.001 * k);
  }
  const std::uint64_t commander = source.commands.at(0).commander;
  const auto accept = [commander](std::uint32_t sequence) {
    return [=](SampleSink& sink) { sink.reply({commander, sequence, true, ""}); };
  };
  source.news = accept(1);
  view.step(0.2);
  source.news = accept(1000);
  view.step(0.3);
  view.step(0.4);
  EXPECT_EQ(source.heartbeats(), 0) << "the first is forgotten, the other was never asked";
  source.news = [commander](SampleSink& sink) { sink.reply({commander, 2, false, "no"}); };
  view.step(0.5);
  source.news = accept(2);
  view.step(0.6);
  view.step(0.7);
  EXPECT_EQ(source.heartbeats(), 0) << "refused, so no longer asked";
  source.news = accept(3);
  view.step(0.8);
  view.received(*page, false, R"({"alive": true})");
  view.step(0.9);
  view.step(1.0);
  EXPECT_EQ(source.heartbeats(), 1);
}

TEST(LiveView, AnAcceptedTokenIsOfItsRun) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  view.opened(page);
  view.received(*page, false, walk_with_token(1, "of the page"));
  view.received(*page, false, R"({"run": "other"})");
  view.step(0.0);
  EXPECT_TRUE(source.chosen.empty()) << "no robot has accepted its token yet";
  source.answers = true;
  view.step(0.1);
  EXPECT_TRUE(page->held);
  view.received(*page, false, R"({"run": "other"})");
  view.step(0.2);
  EXPECT_EQ(source.chosen, "other");
  source.commands.clear();
  view.received(*page, false, walk_with_token(2, "of the page"));
  view.step(0.21);
  const std::uint64_t commander = source.commands.at(0).commander;
  source.commands.clear();
  source.news = [commander](SampleSink& sink) {
    ConfigurationSample next;
    next.run_id = "next";
    sink.configuration(next);
    sink.reply({commander, 2, true, ""});
  };
  view.step(0.25);
  EXPECT_FALSE(page->held);
  view.received(*page, false, R"({"alive": true})");
  view.step(0.3);
  view.step(0.4);
  EXPECT_EQ(source.heartbeats(), 0) << "nor does a late reply of the run before";
}

TEST(LiveView, AHeartbeatComesBeforeWhatPagesSend) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>(), other = std::make_shared<FakePeer>();
  open_with_key(view, page);
  open_with_key(view, other);
  view.received(*page, false, kWalk);
  view.step(0.0);
  source.answers = true;
  view.step(0.1);
  source.commands.clear();
  view.received(*other, false, kWalk);
  view.step(0.2);
  ASSERT_EQ(source.commands.size(), 2u);
  EXPECT_EQ(source.commands[0].kind, CommandKind::heartbeat);
  EXPECT_EQ(source.commands[1].kind, CommandKind::walk);
}

TEST(LiveView, RepliesToAPageThatIsClosedAreNotWaitedFor) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto page = std::make_shared<FakePeer>();
  open_with_key(view, page);
  view.received(*page, false, kWalk);
  view.step(0.0);
  view.closed(*page);
  view.step(0.1);
  EXPECT_EQ(source.forgotten, std::vector<std::uint64_t>{source.commands.at(0).commander});
}

TEST(LiveView, APageThatSendsWithoutEndLosesItsOwnMessagesAndNoneOfAnotherPage) {
  SilentSource source;
  LiveView view(source, kKey);
  const auto flood = std::make_shared<FakePeer>(), operators = std::make_shared<FakePeer>();
  open_with_key(view, flood);
  open_with_key(view, operators);
  for (int k = 0; k < 100'000; ++k) view.received(*flood, false, R"({"alive": true})");
  view.received(*flood, false, kWalk);
  view.received(*operators, false, R"({"command": "stop", "sequence": 1})");
  view.step(0.0);
  ASSERT_EQ(source.commands.size(), 1u);
  EXPECT_EQ(source.commands[0].kind, CommandKind::stop);
}

}  // namespace
}  // namespace stilt::monitor
