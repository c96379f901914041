#include "host_tools/web/monitor/web_server.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "host_tools/web/monitor/send_queue.h"
#include "web_client.h"

namespace stilt::monitor {
namespace {

TEST_F(WebServerTest, ThePageIsAtTheRootAlone) {
  const Client client(server.port());
  client.send(request("/", {{"Host", here()}}));
  const std::string head = client.head();
  EXPECT_EQ(status_of(head), 200);
  EXPECT_NE(head.find("Content-Type: text/html"), std::string::npos) << head;
  EXPECT_NE(head.find("X-Frame-Options: DENY"), std::string::npos) << head;
  EXPECT_EQ(client.rest(), "<p>a page</p>");
  EXPECT_EQ(page("/other", here()), 404);
  EXPECT_EQ(server.url(), "http://" + here() + "/");
}

TEST_F(WebServerTest, OnlyLoopbackNamesOfThisMachineLeadHere) {
  const std::string port = here().substr(here().find(':'));
  for (const std::string host : {"127.0.0.1", "127.1.2.3", "localhost", "[::1]"}) {
    const std::string address = host + port;
    EXPECT_EQ(page("/", address), 200) << host;
    EXPECT_EQ(page("/", host), 200) << host;
    EXPECT_EQ(socket(address, "http://" + address), 101) << host;
  }
  for (const std::string host : {"example.com", "127.example.com", "localhost.example.com",
                                 "127.0.0.1.example.com", "10.0.0.1", "[::2]"}) {
    const std::string address = host + port;
    EXPECT_EQ(page("/", address), 403) << host;
    EXPECT_NE(socket(address, "http://" + address), 101) << host;
    EXPECT_NE(socket(address, ""), 101) << host;
  }
}

TEST_F(WebServerTest, ThePagesOfThisServerGetInAndThoseOfOtherSitesAndWhatHasNoOriginDoNot) {
  const std::string host = here();
  EXPECT_EQ(socket(host, "http://" + host), 101);
  EXPECT_EQ(socket(host, "https://" + host), 101) << "behind a reverse proxy with TLS";
  EXPECT_EQ(socket(host, ""), 403) << "where commands are taken";
  const Client program(server.port());
  program.send(upgrade(host, "", "/viewers"));
  EXPECT_EQ(status_of(program.head()), 101);
  for (const std::string& origin :
       {std::string("http://example.com"), "http://evil" + host, "https://evil" + host, "ftp://" + host, host,
        "http://" + host + ".example.com", std::string("http://127.0.0.1"), std::string("null")}) {
    EXPECT_NE(socket(host, origin), 101) << origin;
  }
}

TEST_F(WebServerTest, ASocketThatIsRefusedGetsAnHttpAnswerThatSaysWhy) {
  const auto answer_to = [this](const std::string& asked) {
    const Client client(server.port());
    client.send(asked);
    const std::string head = client.head();
    return head + client.rest();
  };
  const std::string foreign = answer_to(upgrade(here(), "http://example.com"));
  EXPECT_EQ(status_of(foreign), 403) << foreign;
  EXPECT_NE(foreign.find("--viewers"), std::string::npos) << foreign;
  EXPECT_EQ(status_of(answer_to(upgrade("example.com", "http://example.com"))), 403);
  const std::string none = answer_to(upgrade(here(), "", "/"));
  EXPECT_EQ(status_of(none), 404) << none;
  EXPECT_NE(none.find("no WebSocket at this path"), std::string::npos) << none;
}

TEST_F(WebServerTest, MessagesOfAPageComeAndItsEndIsReported) {
  {
    const Client client(server.port());
    client.send(own_page());
    ASSERT_EQ(status_of(client.head()), 101);
    client.send(std::string("\x81\x82\0\0\0\0hi\x82\x81\0\0\0\0!", 15));  // masked by zeros
    const std::string wanted = "text hi\nbinary !\n";
    EXPECT_EQ(pages.received(wanted.size()), wanted);
    EXPECT_EQ(pages.peer()->subprotocol(), "");
  }
  pages.wait_for_closed(1);
}

/// A client that reads frames itself need not put pieces together. RFC 6455, section 5.2: the shortest
/// length.
TEST_F(WebServerTest, EveryMessageIsOneFrame) {
  const Client client(server.port());
  client.send(own_page());
  ASSERT_EQ(status_of(client.head()), 101);
  const std::pair<std::size_t, std::string> cases[] = {
      {125, std::string("\x82\x7d")},
      {126, std::string("\x82\x7e\0\x7e", 4)},
      {65535, std::string("\x82\x7e\xff\xff")},
      {65536, std::string("\x82\x7f\0\0\0\0\0\x01\0\0", 10)}};
  for (const auto& [size, head] : cases) {
    const std::string bytes(size, 'x');
    pages.peer()->send(std::make_shared<const Message>(Message{bytes, true, false}));
    EXPECT_TRUE(client.next(head.size() + size) == head + bytes) << size;
  }
  pages.peer()->send(std::make_shared<const Message>(Message{"{}", false, true}));
  EXPECT_EQ(client.next(4), "\x81\x02{}");
}

TEST_F(WebServerTest, MessagesComeInTheirOrderFromAnyThread) {
  constexpr int kThreads = 4, kMessages = 2000;
  const Client client(server.port());
  client.send(own_page());
  ASSERT_EQ(status_of(client.head()), 101);
  const std::shared_ptr<Peer> peer = pages.peer();
  std::vector<std::jthread> senders;
  for (int k = 0; k < kThreads; ++k) {
    senders.emplace_back([peer, k] {
      for (int i = 0; i < kMessages; ++i) {
        const std::string bytes = {static_cast<char>(k), static_cast<char>(i / 100),
                                   static_cast<char>(i % 100)};
        peer->send(std::make_shared<const Message>(Message{bytes, true, false}));
      }
    });
  }
  std::array<int, kThreads> next{};
  for (int i = 0; i < kThreads * kMessages; ++i) {
    const std::string frame = client.next(5);
    ASSERT_EQ(frame.substr(0, 2), "\x82\x03") << i;
    ASSERT_LT(frame[2], kThreads);
    ASSERT_EQ(100 * frame[3] + frame[4], next[static_cast<std::size_t>(frame[2])]++)
        << "thread " << int{frame[2]};
  }
}

/// Sockets of viewers agree on the first protocol of the viewer's list that is known.
TEST_F(WebServerTest, ASubprotocolIsTheFirstOneOfferedThatIsKnown) {
  const auto agreed = [this](const std::string& offered) {
    const Client client(server.port());
    std::string asked = upgrade(here(), "", "/protocols");
    asked.insert(asked.size() - 2, "Sec-WebSocket-Protocol: " + offered + "\r\n");
    client.send(asked);
    const std::string head = client.head();
    EXPECT_EQ(status_of(head), 101) << head;
    const std::size_t at = head.find("Sec-WebSocket-Protocol: ");
    return at == std::string::npos ? std::string() : head.substr(at + 24, head.find('\r', at) - at - 24);
  };
  EXPECT_EQ(agreed("stilt.v0, stilt.v2 ,stilt.v1"), "stilt.v2");
  EXPECT_EQ(agreed("stilt.v1"), "stilt.v1");
  EXPECT_EQ(agreed("stilt.v10, stilt"), "");
}

/// RFC 6455, section 1.3.
TEST_F(WebServerTest, AKeyIsAcceptedAsTheStandardSays) {
  const Client client(server.port());
  std::string asked = own_page();
  const std::string key = "c3RpbHRzdGlsdHN0aWx0cw==";
  client.send(asked.replace(asked.find(key), key.size(), "dGhlIHNhbXBsZSBub25jZQ=="));
  const std::string head = client.head();
  EXPECT_NE(head.find("\r\nSec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"), std::string::npos)
      << head;
}

/// The client reads nothing, so what the kernel does not hold is queued.
TEST_F(WebServerTest, APageThatDoesNotKeepUpLosesDroppableMessagesAndNoOthersUntilItIsHopeless) {
  constexpr std::size_t kMessage_bytes = 1U << 20U;
  constexpr std::size_t kKernel_bytes = 1U << 26U;  // more than it takes of one connection
  const auto message = [](bool droppable) {
    return std::make_shared<const Message>(Message{std::string(kMessage_bytes, 'x'), true, droppable});
  };
  {
    const Client client(server.port());
    client.send(own_page());
    ASSERT_EQ(status_of(client.head()), 101);
    const std::shared_ptr<Peer> peer = pages.peer();
    std::uint64_t sent = 0;
    for (; peer->dropped() == 0 && sent * kMessage_bytes < kKernel_bytes; ++sent) peer->send(message(true));
    EXPECT_EQ(peer->dropped(), 1u);
    EXPECT_GT(sent * kMessage_bytes, SendQueue::kCongested_bytes);
    peer->send(message(false));
    EXPECT_EQ(peer->dropped(), 1u);
    for (std::size_t bytes = 0; bytes <= SendQueue::kHopeless_bytes; bytes += kMessage_bytes) {
      peer->send(message(false));
    }
    const std::uint64_t dropped = peer->dropped();
    peer->send(message(true));
    EXPECT_EQ(peer->dropped(), dropped) << "nothing is queued for a connection that was given up";
  }
  pages.wait_for_closed(1);
}

class ServerOfAllAddresses : public WebServerTest {
 protected:
  ServerOfAllAddresses() : WebServerTest({.address = "0.0.0.0", .port = 0, .names = {"robot.example.com"}}) {}
};

TEST_F(ServerOfAllAddresses, AnswersUnderItsOwnNamesAndAddresses) {
  std::array<char, 256> machine{};
  ASSERT_EQ(gethostname(machine.data(), machine.size() - 1), 0);
  std::vector<std::string> hosts = {
      "robot.example.com", "Robot.Example.com:8080", here(),
      "localhost",         machine.data(),           std::string(machine.data()) + ".local:8080"};
  for (const std::string& url : server.urls_for_others()) {
    hosts.push_back(url.substr(7, url.size() - 8));  // without http:// and the last stroke
  }
  for (const std::string& host : hosts) {
    EXPECT_EQ(page("/", host), 200) << host;
    EXPECT_EQ(socket(host, "http://" + host), 101) << host;
  }
  EXPECT_EQ(server.url(), "http://" + here() + "/") << "an address that a browser can open";
}

/// A name of the attacker's that has come to lead here: its pages have it as origin and as host.
TEST_F(ServerOfAllAddresses, GivesAReboundNameNothing) {
  const std::string port = here().substr(here().find(':'));
  for (const std::string host : {"evil.example.com", "robot.example.com.evil.com", "10.255.255.254"}) {
    const std::string address = host + port;
    EXPECT_EQ(page("/", address), 403) << host;
    EXPECT_EQ(socket(address, "http://" + address), 403) << host;
    const Client viewer(server.port());
    viewer.send(upgrade(address, "", "/viewers"));
    EXPECT_EQ(status_of(viewer.head()), 403) << host;
  }
  EXPECT_NE(socket("robot.example.com", "http://example.com"), 101);
}

TEST(WebServer, ThatEndsSaysSoToItsPages) {
  Pages pages;
  auto server = std::make_unique<WebServer>(ServerOptions{.port = 0});
  server->add_endpoint({"/live", {}, {.programs = true}}, pages);
  server->start();
  const Client client(server->port());
  client.send(WebServerTest::upgrade("127.0.0.1", ""));
  ASSERT_EQ(status_of(client.head()), 101);
  const std::shared_ptr<Peer> peer = pages.peer();
  server.reset();
  EXPECT_EQ(client.rest(), "\x88\x02\x03\xe8");
  pages.wait_for_closed(1);
  peer->send(std::make_shared<const Message>(Message{"late", false, false}));  // outlives the server
}

TEST(WebServer, AnAddressThatCannotBeListenedOnIsRefusedInOneSentence) {
  const WebServer first({"127.0.0.1", 0});
  try {
    const WebServer second({"127.0.0.1", first.port()});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(first.port())), std::string::npos);
  }
  constexpr const char* kOfNobody = "192.0.2.1";  // RFC 5737: documentation only
  try {
    const WebServer elsewhere({kOfNobody, 0});
    FAIL();
  } catch (const std::runtime_error& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find(kOfNobody), std::string::npos) << said;
    EXPECT_NE(said.find("this machine has no such address"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace stilt::monitor
