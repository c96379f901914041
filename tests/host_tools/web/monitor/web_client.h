#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/web/monitor/web_server.h"

/// A web server of a test, and clients with any headers.
namespace stilt::monitor {

inline constexpr int kClosed = 0;  ///< instead of a status: the connection was closed without an answer

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
  /// That many of the bytes that come next; fewer when the connection ends.
  [[nodiscard]] std::string next(std::size_t size) const {
    std::string bytes(size, '\0');
    const ssize_t count = ::recv(socket_, bytes.data(), size, MSG_WAITALL);
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    return bytes;
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

inline std::string request(const std::string& path, const Headers& headers) {
  std::string text = "GET " + path + " HTTP/1.1\r\n";
  for (const auto& [name, value] : headers) text.append(name).append(": ").append(value).append("\r\n");
  return text + "\r\n";
}

inline int status_of(const std::string& head) {
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
 public:
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

 protected:
  explicit WebServerTest(const ServerOptions& options = {.port = 0}) : server(options) {
    server.serve_page("<p>a page</p>");
    server.add_endpoint({"/live", {}, {}}, pages);
    server.add_endpoint({"/viewers", {}, {.programs = true}}, viewers);
    server.add_endpoint({"/protocols", {"stilt.v1", "stilt.v2"}, {.programs = true}}, viewers);
    server.start();
  }

  [[nodiscard]] std::string here() const { return "127.0.0.1:" + std::to_string(server.port()); }

  [[nodiscard]] int page(const std::string& path, const std::string& host) const {
    const Client client(server.port());
    client.send(request(path, {{"Host", host}}));
    return status_of(client.head());
  }

  /// A request of this server's own page.
  [[nodiscard]] std::string own_page() const { return upgrade(here(), "http://" + here()); }

  /// Status of a page's WebSocket with that origin; no origin: a program.
  [[nodiscard]] int socket(const std::string& host, const std::string& origin) const {
    const Client client(server.port());
    client.send(upgrade(host, origin));
    return status_of(client.head());
  }

  Pages pages, viewers;  ///< outlive the server
  WebServer server;
};

}  // namespace stilt::monitor
