#include "tests/two_processes/page_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <regex>
#include <stdexcept>

#include "tests/two_processes/process.h"

namespace stilt::two_processes {
namespace {

constexpr auto kPause = std::chrono::milliseconds(5);
constexpr double kWelcome_s = 60.0;

void send_all(int socket, const std::string& bytes) {
  if (::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the monitor does not answer its page");
  }
}

int port_of(const std::string& url) {
  std::smatch match;
  if (std::regex_search(url, match, std::regex("127\\.0\\.0\\.1:([0-9]+)"))) return std::stoi(match[1]);
  throw std::runtime_error("no address of a monitor on this machine: " + url);
}

template <class Question>
bool wait_until(double longest_s, Question&& question) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest_s);
  while (!question()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(kPause);
  }
  return true;
}

}  // namespace

PageClient::PageClient(const std::string& url) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const int port = port_of(url);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket_);
    throw std::runtime_error("nothing listens at " + url);
  }
  const std::string host = "127.0.0.1:" + std::to_string(port);
  send_all(socket_, "GET /live HTTP/1.1\r\nHost: " + host + "\r\nOrigin: http://" + host +
                        "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                        "Sec-WebSocket-Key: c3RpbHRzdGlsdHN0aWx0cw==\r\n\r\n");
  reader_ = std::jthread([this] { read(); });
  if (!wait_for("101 Switching", kWelcome_s)) throw std::runtime_error("the monitor lets no page in");
  const std::size_t key = url.find("#key=");
  if (key != std::string::npos) send(R"({"key": ")" + url.substr(key + 5) + "\"}");
}

PageClient::~PageClient() {
  ::shutdown(socket_, SHUT_RDWR);  // ends the reader
  reader_ = {};
  ::close(socket_);
}

/// Clients mask what they send; a mask of zeros changes nothing.
void PageClient::send(const std::string& json) {
  constexpr char kText = static_cast<char>(0x81), kMasked = static_cast<char>(0x80);
  if (json.size() > 125) throw std::invalid_argument("too long for a page of a test");
  send_all(
      socket_,
      std::string{kText, static_cast<char>(kMasked | static_cast<char>(json.size())), 0, 0, 0, 0} + json);
}

void PageClient::read() {
  std::array<char, 65536> buffer{};
  for (;;) {
    const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), 0);
    const std::lock_guard lock(mutex_);
    if (count <= 0) {
      ended_ = true;
      return;
    }
    came_.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

bool PageClient::wait_for(const std::string& text, double longest_s) {
  return wait_until(longest_s, [&] {
    const std::lock_guard lock(mutex_);
    return came_.find(text) != std::string::npos;
  });
}

bool PageClient::wait_for_end(double longest_s) {
  return wait_until(longest_s, [&] {
    const std::lock_guard lock(mutex_);
    return ended_;
  });
}

std::string url_of_monitor(const std::string& output, double longest_s) {
  if (!wait_for_text(output, "#key=", longest_s)) throw std::runtime_error("the monitor prints no link");
  const std::string text = text_of(output);
  const std::size_t begin = text.find("http://");
  return text.substr(begin, text.find('\n', begin) - begin);
}

}  // namespace stilt::two_processes
