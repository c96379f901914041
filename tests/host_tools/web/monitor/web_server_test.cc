#include "host_tools/web/monitor/web_server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/web/monitor/web_socket_peer.h"

namespace stilt::monitor {
namespace {

constexpr int kClosed = 0;  ///< instead of a status: the connection was closed without an answer

/// A connection to a server on this machine.
class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("nothing listens");
    }
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void send(const std::string& bytes) const {
    ASSERT_EQ(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  /// Head of the answer, as far as it comes.
  [[nodiscard]] std::string head() const {
    std::string head;
    char letter = 0;
    while (!head.ends_with("\r\n\r\n") && ::recv(socket_, &letter, 1, 0) == 1) head += letter;
    return head;
  }
  [[nodiscard]] std::string rest() const {
    std::string rest;
    char letter = 0;
    while (::recv(socket_, &letter, 1, 0) == 1) rest += letter;
    return rest;
  }

 private:
  int socket_;
};

using Headers = std::vector<std::pair<std::string, std::string>>;

std::string request(const std::string& path, const Headers& headers) {
  std::string text = "GET " + path + " HTTP/1.1\r\n";
  for (const auto& [name, value] : headers) text += name + ": " + value + "\r\n";
  return text + "\r\n";
}

int status_of(const std::string& head) {
  return head.starts_with("HTTP/1.1 ") ? std::stoi(head.substr(9)) : kClosed;
}

/// Keeps pages and what they send.
class Pages final : public Endpoint {
 public:
  void opened(const std::shared_ptr<Peer>& peer) override {
    change([&] { peers_.push_back(peer); });
  }
  void received(Peer&, bool binary, std::string_view data) override {
    change([&] {
      received_ += binary ? "binary " : "text ";
      received_ += data;
      received_ += '\n';
    });
  }
  void closed(Peer&) override {
    change([&] { ++closed_; });
  }

  /// The peer of the page that opened last; waits for the first.
  [[nodiscard]] std::shared_ptr<Peer> peer() {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [&] { return !peers_.empty(); });
    return peers_.back();
  }
  /// All that came, once it is that long.
  [[nodiscard]] std::string received(std::size_t size) {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [&] { return received_.size() >= size; });
    return received_;
  }
  void wait_for_closed(int count) {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [&] { return closed_ >= count; });
  }

 private:
  template <class Change>
  void change(Change&& make) {
    const std::lock_guard lock(mutex_);
    make();
    news_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<std::shared_ptr<Peer>> peers_;
  std::string received_;
  int closed_ = 0;
};

class WebServerTest : public testing::Test {
 protected:
  explicit WebServerTest(const std::string& address = "127.0.0.1") : server({address, 0}) {
    server.serve_page("<p>a page</p>");
    server.add_endpoint({"/live", {}, {}}, pages);
  }

  [[nodiscard]] std::string here() const { return "127.0.0.1:" + std::to_string(server.port()); }

  [[nodiscard]] int page(const std::string& path, const std::string& host) const {
    const Client client(server.port());
    client.send(request(path, {{"Host", host}}));
    return status_of(client.head());
  }

  [[nodiscard]] static std::string upgrade(const std::string& host, const std::string& origin,
                                           const std::string& path = "/live") {
    Headers headers = {{"Host", host},
                       {"Connection", "Upgrade"},
                       {"Upgrade", "websocket"},
                       {"Sec-WebSocket-Version", "13"},
                       {"Sec-WebSocket-Key", "c3RpbHRzdGlsdHN0aWx0cw=="}};
    if (!origin.empty()) headers.emplace_back("Origin", origin);
    return request(path, headers);
  }

  /// Status of a page's WebSocket with that origin; no origin: a program.
  [[nodiscard]] int socket(const std::string& host, const std::string& origin) const {
    const Client client(server.port());
    client.send(upgrade(host, origin));
    return status_of(client.head());
  }

  Pages pages;  ///< outlives the server
  WebServer server;
};

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
    EXPECT_EQ(page("/", host + port), 200) << host;
    EXPECT_EQ(page("/", host), 200) << host;
    EXPECT_EQ(socket(host + port, "http://" + host + port), 101) << host;
  }
  for (const std::string host : {"example.com", "127.example.com", "localhost.example.com",
                                 "127.0.0.1.example.com", "10.0.0.1", "[::2]"}) {
    EXPECT_EQ(page("/", host + port), 403) << host;
    EXPECT_NE(socket(host + port, "http://" + host + port), 101) << host;
    EXPECT_NE(socket(host + port, ""), 101) << host;
  }
}

TEST_F(WebServerTest, PagesOfThisServerAndProgramsGetInAndPagesOfOtherSitesDoNot) {
  const std::string host = here();
  EXPECT_EQ(socket(host, "http://" + host), 101);
  EXPECT_EQ(socket(host, ""), 101);
  for (const std::string& origin :
       {std::string("http://example.com"), "http://evil" + host, "https://" + host, host,
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
  EXPECT_EQ(status_of(answer_to(upgrade("example.com", ""))), 403);
  const std::string none = answer_to(upgrade(here(), "", "/"));
  EXPECT_EQ(status_of(none), 404) << none;
  EXPECT_NE(none.find("no WebSocket at this path"), std::string::npos) << none;
}

TEST_F(WebServerTest, MessagesOfAPageComeAndItsEndIsTold) {
  {
    const Client client(server.port());
    client.send(upgrade(here(), ""));
    ASSERT_EQ(status_of(client.head()), 101);
    client.send(std::string("\x81\x82\0\0\0\0hi\x82\x81\0\0\0\0!", 15));  // masked by zeros
    const std::string wanted = "text hi\nbinary !\n";
    EXPECT_EQ(pages.received(wanted.size()), wanted);
    EXPECT_TRUE(pages.peer()->local());
    EXPECT_EQ(pages.peer()->subprotocol(), "");
  }
  pages.wait_for_closed(1);
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
    client.send(upgrade(here(), ""));
    ASSERT_EQ(status_of(client.head()), 101);
    const std::shared_ptr<Peer> peer = pages.peer();
    std::uint64_t sent = 0;
    for (; peer->dropped() == 0 && sent * kMessage_bytes < kKernel_bytes; ++sent) peer->send(message(true));
    EXPECT_EQ(peer->dropped(), 1u);
    EXPECT_GT(sent * kMessage_bytes, WebSocketPeer::kCongested_bytes);
    peer->send(message(false));
    EXPECT_EQ(peer->dropped(), 1u);
    for (std::size_t bytes = 0; bytes <= WebSocketPeer::kHopeless_bytes; bytes += kMessage_bytes) {
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
  ServerOfAllAddresses() : WebServerTest("0.0.0.0") {}
};

TEST_F(ServerOfAllAddresses, AnswersUnderAnyNameButPagesOfOtherSites) {
  EXPECT_EQ(page("/", "robot.example.com"), 200);
  EXPECT_EQ(socket("robot.example.com", "http://robot.example.com"), 101);
  EXPECT_NE(socket("robot.example.com", "http://example.com"), 101);
}

TEST(WebServer, AnAddressThatCannotBeListenedOnIsRefusedInOneSentence) {
  const WebServer first({"127.0.0.1", 0});
  try {
    const WebServer second({"127.0.0.1", first.port()});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(first.port())), std::string::npos);
  }
}

}  // namespace
}  // namespace stilt::monitor
