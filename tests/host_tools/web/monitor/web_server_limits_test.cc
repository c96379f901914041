// What a client may send to a web server, and how many connections it has.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "web_client.h"

namespace stilt::monitor {
namespace {

/// A masked frame of a client; the mask of zeros changes nothing.
std::string frame(unsigned char first, const std::string& payload) {
  std::string bytes{static_cast<char>(first)};
  if (payload.size() < 126) {
    bytes += static_cast<char>(0x80U | payload.size());
  } else {
    bytes += static_cast<char>(0xfe);
    bytes += static_cast<char>(payload.size() >> 8U);
    bytes += static_cast<char>(payload.size() & 0xffU);
  }
  return bytes + std::string(4, '\0') + payload;
}

TEST_F(WebServerTest, FragmentsAreOneMessageAndAPingBetweenThemIsAnswered) {
  const Client client(server.port());
  client.send(own_page());
  ASSERT_EQ(status_of(client.head()), 101);
  client.send(frame(0x01, "st") + frame(0x89, "alive?") + frame(0x80, "op"));
  const std::string wanted = "text stop\n";
  EXPECT_EQ(pages.received(wanted.size()), wanted);
  client.send(frame(0x88, "\x03\xe8"));
  EXPECT_EQ(client.rest(),
            "\x8a\x06"
            "alive?\x88\x02\x03\xe8")
      << "pong, then the end";
}

TEST_F(WebServerTest, AMessageThatIsTooLongOrMalformedEndsItsConnectionBeforeItIsKept) {
  const std::string too_big = "\x88\x02\x03\xf1", malformed = "\x88\x02\x03\xea";
  const std::string huge("\x82\xff\0\0\0\0\x7f\0\0\0mask", 14), largest(60'000, 'x');
  const std::pair<std::string, std::string> cases[] = {
      {huge, too_big},                                         // its head alone
      {frame(0x01, largest) + frame(0x00, largest), too_big},  // together
      {std::string("\x81\x02hi"), malformed},                  // not masked
      {frame(0x80, "hi"), malformed},                          // continues nothing
      {frame(0x01, "hi") + frame(0x81, "hi"), malformed},      // begins another
      {frame(0xc1, "hi"), malformed},                          // compressed, which was not agreed on
      {frame(0x83, "hi"), malformed},                          // of no kind there is
      {frame(0x89, std::string(126, 'x')), malformed},         // a long ping
      {frame(0x81, "\xff"), "\x88\x02\x03\xef"}};              // no UTF-8
  for (const auto& [bytes, end] : cases) {
    const Client client(server.port());
    client.send(own_page());
    ASSERT_EQ(status_of(client.head()), 101);
    client.send(bytes);
    EXPECT_EQ(client.rest(), end) << bytes.substr(0, 8);
  }
  pages.wait_for_closed(static_cast<int>(std::size(cases)));
}

TEST_F(WebServerTest, ARequestThatIsAmbiguousMalformedOrTooLongIsRefused) {
  const auto status = [this](const std::string& text) {
    const Client client(server.port());
    client.send(text);
    return status_of(client.head());
  };
  EXPECT_EQ(status(request("/", {{"Host", here()}, {"Host", "example.com"}})), 400);
  EXPECT_EQ(status(request("/", {})), 403) << "without a host";
  EXPECT_EQ(status("hello\r\n\r\n"), 400);
  EXPECT_EQ(status("POST / HTTP/1.1\r\nHost: " + here() + "\r\n\r\n"), 405);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: " + here() + "\r\nX: " + std::string(20'000, 'x')), 431);
}

/// Text of a page that arrives while others are connected and silent.
constexpr const char* kStop = R"({"command": "stop", "sequence": 1})";

TEST_F(WebServerTest, StopOfAnOpenPageAndOfANewOneArriveAmongAHundredIdleSocketsOfEachKind) {
  const Client open(server.port());
  open.send(own_page());
  ASSERT_EQ(status_of(open.head()), 101);
  pages.peer()->hold(true);
  std::vector<std::unique_ptr<Client>> idle;
  for (int k = 0; k < 100; ++k) {
    idle.push_back(std::make_unique<Client>(server.port()));  // says nothing
    idle.push_back(std::make_unique<Client>(server.port()));
    idle.back()->send(upgrade(here(), "", "/viewers"));
    idle.push_back(std::make_unique<Client>(server.port()));
    idle.back()->send("GET / HTTP/1.1\r\n");  // never ends
  }
  open.send(frame(0x81, kStop));
  const std::string once = std::string("text ") + kStop + "\n";
  EXPECT_EQ(pages.received(once.size()), once);
  const Client newcomer(server.port());
  newcomer.send(own_page());
  ASSERT_EQ(status_of(newcomer.head()), 101);
  newcomer.send(frame(0x81, kStop));
  EXPECT_EQ(pages.received(2 * once.size()), once + once);
}

class ServerForThree : public WebServerTest {
 protected:
  ServerForThree() : WebServerTest({.port = 0, .connections_max = 3}) {}
};

TEST_F(ServerForThree, ClosesTheSilentForANewcomerAndNeverAHeldPage) {
  const Client held(server.port());
  held.send(own_page());
  ASSERT_EQ(status_of(held.head()), 101);
  pages.peer()->hold(true);
  const Client silent(server.port());
  const Client page(server.port());
  page.send(own_page());
  ASSERT_EQ(status_of(page.head()), 101);
  const Client second_page(server.port());
  second_page.send(own_page());
  ASSERT_EQ(status_of(second_page.head()), 101);
  EXPECT_EQ(silent.rest(), "") << "the first to go is one without a request";
  const Client third_page(server.port());
  third_page.send(own_page());
  ASSERT_EQ(status_of(third_page.head()), 101);
  EXPECT_EQ(page.rest(), "") << "then the page that has been silent longest";
  pages.wait_for_closed(1);
  held.send(frame(0x81, kStop));
  const std::string once = std::string("text ") + kStop + "\n";
  EXPECT_EQ(pages.received(once.size()), once);
}

/// Waits as long as the server does.
TEST_F(WebServerTest, ARequestThatDoesNotComeAndAnEndThatIsNotTakenEndTheirConnections) {
  const Client half(server.port());
  half.send("GET / HTTP/1.1\r\n");
  const Client malformed(server.port());
  malformed.send(own_page());
  ASSERT_EQ(status_of(malformed.head()), 101);
  malformed.send(frame(0x80, "hi"));
  EXPECT_EQ(half.rest(), "");
  pages.wait_for_closed(1);
}

/// The server's ends of connections are sockets of this process.
std::vector<int> server_ends(int port) {
  constexpr int kDescriptors = 1024;
  std::vector<int> found;
  for (int socket = 0; socket < kDescriptors; ++socket) {
    sockaddr_in here{}, there{};
    socklen_t here_bytes = sizeof here, there_bytes = sizeof there;
    const bool connected = getsockname(socket, reinterpret_cast<sockaddr*>(&here), &here_bytes) == 0 &&
                           getpeername(socket, reinterpret_cast<sockaddr*>(&there), &there_bytes) == 0;
    if (connected && here.sin_family == AF_INET && ntohs(here.sin_port) == port) found.push_back(socket);
  }
  return found;
}

TEST_F(WebServerTest, AConnectionWhoseOtherEndTakesNothingMoreEndsAfter35Seconds) {
  const Client client(server.port());
  client.send(own_page());
  ASSERT_EQ(status_of(client.head()), 101);
  const std::vector<int> ends = server_ends(server.port());
  ASSERT_EQ(ends.size(), 1u);
  int limit_ms = 0;
  socklen_t bytes = sizeof limit_ms;
  ASSERT_EQ(getsockopt(ends[0], IPPROTO_TCP, TCP_USER_TIMEOUT, &limit_ms, &bytes), 0);
  EXPECT_EQ(limit_ms, 35'000);
}

TEST_F(WebServerTest, WhatHasNotOpenedASocketHasNoMessages) {
  const Client eager(server.port());
  eager.send(own_page() + frame(0x81, kStop));
  EXPECT_EQ(status_of(eager.head()), 400) << "a page begins after the answer";
  const Client old(server.port());
  std::string asked = own_page();
  old.send(asked.replace(asked.find("Version: 13"), 11, "Version: 8"));
  EXPECT_EQ(status_of(old.head()), 426);
}

}  // namespace
}  // namespace stilt::monitor
