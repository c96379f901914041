#include "host_tools/web/foxglove/foxglove_endpoint.h"

#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "firmware/telemetry/cdr.h"
#include "firmware/telemetry/topics.h"
#include "tests/independent_readers/run_reader.h"

namespace stilt::foxglove {
namespace {

using Json = nlohmann::json;

telemetry::Sample twist() {
  telemetry::Twist message{};
  message.linear.x = 0.25;
  message.angular.z = -1.5;
  return {&telemetry::kSpeedCommands, 0, 0, telemetry::encode(message)};
}

telemetry::Sample reply(std::uint64_t number) {
  std::string commander = "somebody", reason = "no";
  telemetry::CommandReply message{};
  message.commander = commander.data();
  message.reason = reason.data();
  message.number = number;
  return {&telemetry::kCommandReplies, 0, 0, telemetry::encode(message)};
}

telemetry::Sample event(std::uint64_t number) {
  std::string name = "walk", text = "the robot walks";
  telemetry::Event message{};
  message.number = number;
  message.name = name.data();
  message.text = text.data();
  return {&telemetry::kEvents, 0, 0, telemetry::encode(message)};
}

class EachName : public testing::TestWithParam<const char*> {};

TEST_P(EachName, AViewerFindsTopicsAndReadsMessages) {
  FoxgloveEndpoint endpoint("a robot");
  monitor::WebServer server({"127.0.0.1", 0});
  server.serve_page("<p>a page at the same address</p>");
  server.add_endpoint(FoxgloveEndpoint::options(), endpoint);
  server.start();
  endpoint.publish(event(7), 6'000'000'000);  // before anybody is there
  std::jthread robot([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      endpoint.publish(twist(), 5'000'000'001);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  const std::string url = "ws://127.0.0.1:" + std::to_string(server.port());
  const Json found =
      independent_readers::run_reader("foxglove_client.cjs", {url, GetParam(), "/cmd_vel", "/stilt/event"});
  EXPECT_EQ(found["protocol"], GetParam());
  EXPECT_EQ(found["info"]["name"], "a robot");
  EXPECT_EQ(found["channels"].size(), telemetry::topics().size() - 1)
      << "all but commands, which hold the token";
  EXPECT_EQ(found["messages"]["/cmd_vel"]["timestamp"], "5000000001");
  EXPECT_EQ(found["messages"]["/cmd_vel"]["message"]["linear"]["x"], 0.25);
  EXPECT_EQ(found["messages"]["/cmd_vel"]["message"]["angular"]["z"], -1.5);
  EXPECT_EQ(found["messages"]["/stilt/event"]["message"]["number"], "7")
      << "what lasts comes to the late, too";
}

INSTANTIATE_TEST_SUITE_P(FoxgloveEndpoint, EachName,
                         testing::Values("foxglove.sdk.v1", "foxglove.websocket.v1"), [](const auto& row) {
                           return row.param == std::string("foxglove.sdk.v1") ? "sdk" : "old";
                         });

/// Something that commands, at the same address.
class Commands final : public monitor::Endpoint {
 public:
  void opened(const std::shared_ptr<monitor::Peer>&) override { ++pages; }
  void received(monitor::Peer&, bool, std::string_view) override {}
  void closed(monitor::Peer&) override {}
  std::atomic<int> pages = 0;
};

class PagesOfOtherSites : public testing::Test {
 protected:
  void serve(const monitor::Origins& viewers) {
    server.serve_page("<p>a page</p>");
    server.add_endpoint(FoxgloveEndpoint::options(viewers), endpoint);
    server.add_endpoint({"/live", {}, {}}, commands);
    server.start();
    endpoint.publish(event(7), 6'000'000'000);
  }
  /// What a page of that site finds out there.
  [[nodiscard]] Json look(const std::string& path, const std::string& site) const {
    return independent_readers::run_reader(
        "foxglove_client.cjs", {"ws://127.0.0.1:" + std::to_string(server.port()) + path, "foxglove.sdk.v1",
                                "--origin=" + site, "/stilt/event"});
  }
  FoxgloveEndpoint endpoint{"a robot"};
  Commands commands;
  monitor::WebServer server{{"127.0.0.1", 0}};
};

TEST_F(PagesOfOtherSites, MayLookAndAreOfferedNothingToPublish) {
  serve({.any = true});
  for (const std::string site : {"https://app.foxglove.dev", "http://localhost:8081"}) {
    const Json found = look("/", site);
    EXPECT_EQ(found["messages"]["/stilt/event"]["message"]["number"], "7") << site;
    EXPECT_TRUE(found["info"]["capabilities"].empty()) << site;
  }
}

TEST_F(PagesOfOtherSites, ReachNothingThatCommandsUnderTheViewersNameEither) {
  serve({.any = true});
  EXPECT_THROW(static_cast<void>(look("/live", "https://app.foxglove.dev")), std::runtime_error);
  EXPECT_EQ(commands.pages, 0);
}

TEST_F(PagesOfOtherSites, AreLetInByNameWhereTheUserNamesThem) {
  serve({.any = false, .named = {"https://app.foxglove.dev"}});
  EXPECT_EQ(look("/", "https://app.foxglove.dev")["messages"].size(), 1u);
  for (const std::string site :
       {"https://example.com", "http://app.foxglove.dev", "https://app.foxglove.dev:81"}) {
    EXPECT_THROW(static_cast<void>(look("/", site)), std::runtime_error) << site;
  }
}

/// Keeps what is sent.
class FakePeer final : public monitor::Peer {
 public:
  std::vector<monitor::SharedMessage> sent;
  void send(monitor::SharedMessage message) override { sent.push_back(std::move(message)); }
  [[nodiscard]] std::uint64_t dropped() const override { return 0; }
  void hold(bool) override {}
  [[nodiscard]] const std::string& subprotocol() const override { return subprotocol_; }

 private:
  std::string subprotocol_ = "foxglove.sdk.v1";
};

class Connected : public testing::Test {
 protected:
  Connected() { endpoint.opened(peer); }

  [[nodiscard]] std::size_t channel(const std::string& topic) const {
    const Json advertised = Json::parse(peer->sent.at(1)->bytes);
    for (const Json& entry : advertised["channels"]) {
      if (entry["topic"] == topic) return entry["id"];
    }
    throw std::runtime_error(topic);
  }
  void say(const Json& json) { endpoint.received(*peer, false, json.dump()); }
  void subscribe(int id, const std::string& topic) {
    say({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel(topic)}}}}});
  }
  [[nodiscard]] Json last() const { return Json::parse(peer->sent.back()->bytes); }

  FoxgloveEndpoint endpoint{"a robot"};
  std::shared_ptr<FakePeer> peer = std::make_shared<FakePeer>();
};

TEST_F(Connected, NothingComesWithoutASubscriptionAndAfterItsEnd) {
  const std::size_t before = peer->sent.size();
  endpoint.publish(twist(), 1);
  EXPECT_EQ(peer->sent.size(), before);
  subscribe(3, "/cmd_vel");
  endpoint.publish(twist(), 1);
  endpoint.publish(reply(1), 1);
  EXPECT_EQ(peer->sent.size(), before + 1);
  say({{"op", "unsubscribe"}, {"subscriptionIds", {3}}});
  endpoint.publish(twist(), 1);
  EXPECT_EQ(peer->sent.size(), before + 1);
}

TEST_F(Connected, AMessageIsOneSubscriptionTimeAndCdr) {
  subscribe(0x0403, "/stilt/command_reply");
  const telemetry::Sample sample = reply(9);
  endpoint.publish(sample, 0x1122334455667788);
  const std::string& bytes = peer->sent.back()->bytes;
  EXPECT_TRUE(peer->sent.back()->binary);
  const std::string head("\x01\x03\x04\x00\x00\x88\x77\x66\x55\x44\x33\x22\x11", 13);
  EXPECT_EQ(bytes.substr(0, 13), head);
  EXPECT_EQ(bytes.substr(13),
            std::string(reinterpret_cast<const char*>(sample.cdr.data()), sample.cdr.size()));
}

TEST_F(Connected, StreamsMayBeDroppedForASlowViewerAndEventsMayNot) {
  subscribe(1, "/cmd_vel");
  subscribe(2, "/stilt/event");
  endpoint.publish(twist(), 1);
  EXPECT_TRUE(peer->sent.back()->droppable);
  endpoint.publish(event(1), 1);
  EXPECT_FALSE(peer->sent.back()->droppable);
}

/// Each subscription gets a copy of every message.
TEST_F(Connected, AClientHasAsManySubscriptionsAsThereAreChannels) {
  const std::size_t channels = Json::parse(peer->sent.at(1)->bytes)["channels"].size();
  const std::size_t twists = channel("/cmd_vel");
  Json all = Json::array();
  for (std::size_t id = 0; id < 10 * channels; ++id) all.push_back({{"id", id}, {"channelId", twists}});
  const std::size_t before = peer->sent.size();
  say({{"op", "subscribe"}, {"subscriptions", all}});
  ASSERT_EQ(peer->sent.size(), before + 1) << "one error";
  EXPECT_EQ(last()["op"], "status");
  EXPECT_NE(last()["message"].get<std::string>().find("unsubscribe from one first"), std::string::npos);
  endpoint.publish(twist(), 1);
  EXPECT_EQ(peer->sent.size(), before + 1 + channels);
  subscribe(0, "/stilt/command_reply");
  endpoint.publish(reply(1), 1);
  EXPECT_EQ(peer->sent.size(), before + 2 + channels) << "its own subscriptions change";
}

TEST_F(Connected, WhatIsNotUnderstoodIsAnsweredWithAnError) {
  for (const std::string text :
       {"", "no json", "[]", "{}", R"({"op": "advertise"})", R"({"op": "subscribe"})", R"({"op": 5})",
        R"({"op": "subscribe", "subscriptions": [{"id": "x"}]})",
        R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 99}]})",
        R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": -1}]})"}) {
    const std::size_t before = peer->sent.size();
    endpoint.received(*peer, false, text);
    ASSERT_EQ(peer->sent.size(), before + 1) << text;
    EXPECT_EQ(last()["op"], "status") << text;
    EXPECT_EQ(last()["level"], 2) << text;
  }
}

TEST_F(Connected, WhoHasGoneGetsNothing) {
  subscribe(1, "/cmd_vel");
  endpoint.closed(*peer);
  EXPECT_FALSE(endpoint.has_clients());
  const std::size_t before = peer->sent.size();
  endpoint.publish(twist(), 1);
  endpoint.received(*peer, false, "{}");
  EXPECT_EQ(peer->sent.size(), before);
}

}  // namespace
}  // namespace stilt::foxglove
