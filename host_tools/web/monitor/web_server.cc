#include "host_tools/web/monitor/web_server.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "host_tools/web/monitor/web_connection.h"

// One page, one socket, one thread: docs/decisions/0011-monitor.md; who may command: 0020-one-commander.md
namespace stilt::monitor {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// How often is checked which connection is late.
constexpr auto kLook = std::chrono::milliseconds(500);

std::string url_of(const std::string& host, int port) {
  return "http://" + host + ":" + std::to_string(port) + "/";
}

/// The kernel closes connections whose other end is gone, such as a phone that left the network, in 35 s. It
/// asks nothing while sent bytes wait for their acknowledgement; these have a limit of their own.
void configure(int socket) {
  const auto set = [socket](int level, int name, int value) {
    setsockopt(socket, level, name, &value, sizeof value);
  };
  set(IPPROTO_TCP, TCP_NODELAY, 1);
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 20);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 5);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
  set(IPPROTO_TCP, TCP_USER_TIMEOUT, 35'000);  // ms
}

}  // namespace

class WebServer::Implementation {
 public:
  explicit Implementation(const ServerOptions& options)
      : connections_max_(options.connections_max),
        site_{.names = {options.address, options.names},
              .html = {},
              .message_bytes_max = options.message_bytes_max} {
    if (!listen(options)) {
      throw std::runtime_error(
          "monitor: cannot listen on " + in_brackets(options.address) + ":" + std::to_string(options.port) +
          "; either another program uses the port (--port chooses one, 0: any free one), "
          "or this machine has no such address");
    }
  }

  ~Implementation() {
    io_.stop();
    if (thread_.joinable()) thread_.join();
    for (const auto& connection : connections_) connection->say_goodbye();
    while (!connections_.empty()) (*connections_.begin())->end();
  }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void start() {
    accept();
    look();
    thread_ = std::thread([this] { io_.run(); });
  }

  [[nodiscard]] WebSite& site() { return site_; }
  [[nodiscard]] int port() const { return listener_.local_endpoint().port(); }

 private:
  bool listen(const ServerOptions& options) {
    error_code error;
    const auto found =
        tcp::resolver(io_).resolve(options.address, std::to_string(options.port),
                                   tcp::resolver::passive | tcp::resolver::numeric_service, error);
    if (error || found.empty()) return false;
    const tcp::endpoint address = found.begin()->endpoint();
    (void)listener_.open(address.protocol(), error);
    if (!error) (void)listener_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) (void)listener_.bind(address, error);
    if (!error) (void)listener_.listen(tcp::acceptor::max_listen_connections, error);
    return !error;
  }

  void accept() {
    listener_.async_accept([this](error_code error, tcp::socket socket) {
      const bool without_room =
          error == asio::error::no_descriptors || error == boost::system::errc::too_many_files_open_in_system;
      if (!error) admit(std::move(socket));
      if (!error || (without_room && make_room())) return accept();
      accepts_ = false;  // until the next look
    });
    accepts_ = true;
  }

  void admit(tcp::socket socket) {
    if (connections_.size() >= connections_max_ && !make_room()) return;
    configure(socket.native_handle());
    const auto ended = [this](WebConnection& connection) {
      connections_.erase(connection.shared_from_this());
    };
    const auto connection = std::make_shared<WebConnection>(std::move(socket), site_, ended);
    connections_.insert(connection);
    connection->start();
  }

  /// Closes the connection that is worth least. False when all are held.
  bool make_room() {
    const auto least = std::ranges::min_element(connections_, {}, &WebConnection::worth);
    if (least == connections_.end() || (*least)->held()) return false;
    (*least)->end();
    return true;
  }

  void look() {
    const auto now = WebConnection::Clock::now();
    const std::vector<std::shared_ptr<WebConnection>> all(connections_.begin(), connections_.end());
    for (const auto& connection : all) {
      if (connection->late(now)) connection->end();
    }
    if (!accepts_) accept();
    timer_.expires_after(kLook);
    timer_.async_wait([this](error_code) { look(); });
  }

  const std::size_t connections_max_;
  WebSite site_;
  asio::io_context io_{1};
  tcp::acceptor listener_{io_};
  asio::steady_timer timer_{io_};
  std::set<std::shared_ptr<WebConnection>> connections_;
  bool accepts_ = false;
  std::thread thread_;
};

WebServer::WebServer(const ServerOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

WebServer::~WebServer() = default;

void WebServer::serve_page(std::string_view html) { implementation_->site().html = html; }

void WebServer::add_endpoint(const EndpointOptions& options, Endpoint& endpoint) {
  implementation_->site().sockets.push_back({options, &endpoint});
}

void WebServer::start() { implementation_->start(); }

int WebServer::port() const { return implementation_->port(); }

std::string WebServer::url() const {
  const std::string& address = implementation_->site().names.address;
  const bool everywhere = address == "0.0.0.0" || address == "::";
  return url_of(everywhere ? std::string("127.0.0.1") : in_brackets(address), port());
}

std::vector<std::string> WebServer::urls_for_others() const {
  std::vector<std::string> urls;
  for (const std::string& host : implementation_->site().names.for_others()) {
    urls.push_back(url_of(host, port()));
  }
  return urls;
}

}  // namespace stilt::monitor
