#include "host_tools/web/monitor/web_server.h"

#include <arpa/inet.h>
#include <civetweb.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>

#include "host_tools/web/monitor/web_socket_peer.h"

// One page, one socket, who may command: docs/decisions/0011-monitor.md
namespace stilt::monitor {
namespace {

constexpr int kSwitchingRefused = 1;
constexpr int kProceed = 0;

/// Whether a host is a loopback address or "localhost". A name such as 127.example.com can lead to any host.
bool is_loopback(const std::string& host) {
  in_addr number{};
  if (inet_pton(AF_INET, host.c_str(), &number) == 1) return (ntohl(number.s_addr) >> 24U) == IN_LOOPBACKNET;
  return host == "localhost" || host == "::1" || host == "[::1]";
}

std::string in_brackets(const std::string& address) {
  return address.find(':') == std::string::npos || address.starts_with('[') ? address : "[" + address + "]";
}

/// The host of "host:port" or "host".
std::string host_part(const std::string& host) {
  const std::size_t colon = host.rfind(':');
  const bool has_port = colon != std::string::npos && host.find(']', colon) == std::string::npos;
  return has_port ? host.substr(0, colon) : host;
}

std::string header(const mg_connection* connection, const char* name) {
  const char* value = mg_get_header(connection, name);
  return value == nullptr ? std::string() : std::string(value);
}

void answer(mg_connection* connection, const char* status, std::string_view type, std::string_view text) {
  mg_printf(connection,
            "HTTP/1.1 %s\r\nContent-Type: %.*s; charset=utf-8\r\nContent-Length: %zu\r\n"
            "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n"
            "Referrer-Policy: no-referrer\r\nConnection: close\r\n\r\n",
            status, static_cast<int>(type.size()), type.data(), text.size());
  mg_write(connection, text.data(), text.size());
}

}  // namespace

class WebServer::Implementation {
 public:
  explicit Implementation(const ServerOptions& options) : options_(options) {
    mg_init_library(0);
    const std::string port = in_brackets(options.address) + ":" + std::to_string(options.port);
    const char* settings[] = {"listening_ports",
                              port.c_str(),
                              "num_threads",
                              "24",
                              "websocket_timeout_ms",
                              "3600000",
                              "request_timeout_ms",
                              "5000",
                              "enable_directory_listing",
                              "no",
                              "tcp_nodelay",
                              "1",
                              nullptr};
    mg_callbacks callbacks{};
    callbacks.log_message = [](const mg_connection*, const char*) {
      return 1;
    };  // errors are returned as statuses
    context_ = mg_start(&callbacks, this, static_cast<const char**>(settings));
    if (context_ == nullptr) {
      mg_exit_library();
      throw std::runtime_error("monitor: cannot listen on " + port +
                               "; either another program uses the port (--port chooses one, 0: any free "
                               "one), or this machine has no "
                               "such address");
    }
    mg_server_port ports[1];
    if (mg_get_server_ports(context_, 1, static_cast<mg_server_port*>(ports)) == 1) port_ = ports[0].port;
    mg_set_request_handler(context_, "**", &Implementation::answer_request, this);
    mg_set_websocket_handler(context_, "/**", &Implementation::no_such_socket, nullptr, nullptr, nullptr,
                             nullptr);
  }

  ~Implementation() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    for (const auto& peer : all_peers()) peer->stop();
    mg_stop(context_);
    mg_exit_library();
  }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void serve_page(std::string_view html) { html_ = html; }

  void add_endpoint(const EndpointOptions& options, Endpoint& endpoint) {
    auto& socket = sockets_.emplace_back(std::make_unique<Socket>());
    socket->server = this;
    socket->endpoint = &endpoint;
    socket->options = options;
    for (const std::string& name : socket->options.subprotocols) socket->names.push_back(name.c_str());
    socket->accepted = {static_cast<int>(socket->names.size()), socket->names.data()};
    mg_set_websocket_handler_with_subprotocols(context_, socket->options.path.c_str(),
                                               socket->names.empty() ? nullptr : &socket->accepted,
                                               &Implementation::connecting, &Implementation::ready,
                                               &Implementation::data, &Implementation::closing, socket.get());
  }

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] const ServerOptions& options() const { return options_; }

 private:
  struct Socket {
    Implementation* server = nullptr;
    Endpoint* endpoint = nullptr;
    EndpointOptions options;
    std::vector<const char*> names;
    mg_websocket_subprotocols accepted{};
  };

  /// Whether the request names this server as its host.
  [[nodiscard]] bool host_fits(const mg_connection* connection) const {
    if (!is_loopback(options_.address)) return true;
    return is_loopback(host_part(header(connection, "Host")));
  }

  static int answer_request(mg_connection* connection, void* self) {
    const auto& server = *static_cast<Implementation*>(self);
    if (!server.host_fits(connection)) {
      answer(connection, "403 Forbidden", "text/plain", "Open this page by its loopback address.\n");
      return 403;
    }
    if (mg_get_request_info(connection)->local_uri != std::string_view("/")) {
      answer(connection, "404 Not Found", "text/plain", "There is one page here, at /.\n");
      return 404;
    }
    answer(connection, "200 OK", "text/html", server.html_);
    return 200;
  }

  /// Says why in HTTP: viewers show it. civetweb itself would close without a word, or without a header.
  static int refuse_socket(const mg_connection* connection, const char* status, std::string_view sentence) {
    answer(const_cast<mg_connection*>(connection), status, "text/plain", sentence);
    return kSwitchingRefused;
  }

  static int no_such_socket(const mg_connection* connection, void* /*context*/) {
    return refuse_socket(connection, "404 Not Found", "There is no WebSocket at this path.\n");
  }

  static int connecting(const mg_connection* connection, void* context) {
    const auto& socket = *static_cast<Socket*>(context);
    if (!socket.server->host_fits(connection)) {
      return refuse_socket(connection, "403 Forbidden", "Open this page by its loopback address.\n");
    }
    const std::string origin = header(connection, "Origin");
    const Origins& others = socket.options.origins;
    const bool welcome = origin.empty() || origin == "http://" + header(connection, "Host") || others.any ||
                         std::ranges::find(others.named, origin) != others.named.end();
    if (welcome) return kProceed;
    return refuse_socket(connection, "403 Forbidden",
                         "Pages of this site may not look: start stilt monitor with --viewers.\n");
  }

  static void ready(mg_connection* connection, void* context) {
    const auto& socket = *static_cast<Socket*>(context);
    auto peer = std::make_shared<WebSocketPeer>(connection);
    {
      const std::lock_guard lock(socket.server->mutex_);
      if (socket.server->stopping_) return;
      socket.server->peers_[connection] = peer;
    }
    socket.endpoint->opened(peer);
  }

  static int data(mg_connection* connection, int bits, char* bytes, std::size_t size, void* context) {
    const auto& socket = *static_cast<Socket*>(context);
    const int opcode = bits & 0xF;
    if (opcode == MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE) return 0;
    const bool binary = opcode == MG_WEBSOCKET_OPCODE_BINARY;
    if (!binary && opcode != MG_WEBSOCKET_OPCODE_TEXT) return 1;
    if (const auto peer = socket.server->peer_of(connection)) {
      socket.endpoint->received(*peer, binary, {bytes, size});
    }
    return 1;
  }

  static void closing(const mg_connection* connection, void* context) {
    const auto& socket = *static_cast<Socket*>(context);
    const auto peer = socket.server->peer_of(connection);
    if (!peer) return;
    socket.endpoint->closed(*peer);
    peer->stop();
    const std::lock_guard lock(socket.server->mutex_);
    socket.server->peers_.erase(connection);
  }

  std::shared_ptr<WebSocketPeer> peer_of(const mg_connection* connection) {
    const std::lock_guard lock(mutex_);
    const auto found = peers_.find(connection);
    return found == peers_.end() ? nullptr : found->second;
  }

  std::vector<std::shared_ptr<WebSocketPeer>> all_peers() {
    const std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<WebSocketPeer>> peers;
    for (const auto& [connection, peer] : peers_) peers.push_back(peer);
    return peers;
  }

  ServerOptions options_;
  mg_context* context_ = nullptr;
  int port_ = 0;
  std::string_view html_;
  std::vector<std::unique_ptr<Socket>> sockets_;
  std::mutex mutex_;
  std::map<const mg_connection*, std::shared_ptr<WebSocketPeer>> peers_;
  bool stopping_ = false;
};

WebServer::WebServer(const ServerOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

WebServer::~WebServer() = default;

void WebServer::serve_page(std::string_view html) { implementation_->serve_page(html); }

void WebServer::add_endpoint(const EndpointOptions& options, Endpoint& endpoint) {
  implementation_->add_endpoint(options, endpoint);
}

int WebServer::port() const { return implementation_->port(); }

std::string WebServer::url() const {
  return "http://" + in_brackets(implementation_->options().address) + ":" + std::to_string(port()) + "/";
}

}  // namespace stilt::monitor
