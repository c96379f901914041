#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace stilt::monitor {

/// A WebSocket message, shared by all its receivers.
struct Message {
  std::string bytes;
  bool binary = false;
  bool droppable = false;  ///< may be left out for a slow peer
};
using SharedMessage = std::shared_ptr<const Message>;

/// One WebSocket connection. Any thread.
class Peer {
 public:
  virtual ~Peer() = default;

  /// Queues a message and returns at once. A slow peer loses droppable messages; it is disconnected when its
  /// other messages pile up.
  virtual void send(SharedMessage message) = 0;

  /// Messages left out so far.
  [[nodiscard]] virtual std::uint64_t dropped() const = 0;

  /// Whether the other end is on this machine.
  [[nodiscard]] virtual bool local() const = 0;

  /// The agreed subprotocol; empty when there is none.
  [[nodiscard]] virtual const std::string& subprotocol() const = 0;
};

/// Handler of a WebSocket path. Called from the server's threads; calls for one peer are in order.
class Endpoint {
 public:
  virtual ~Endpoint() = default;
  virtual void opened(const std::shared_ptr<Peer>& peer) = 0;
  virtual void received(Peer& peer, bool binary, std::string_view data) = 0;
  virtual void closed(Peer& peer) = 0;
};

/// Other web sites whose pages may connect, besides those of this server. Programs, which send no origin, may
/// always connect.
struct Origins {
  bool any = false;
  std::vector<std::string> named{};  ///< "https://app.foxglove.dev"
};

struct EndpointOptions {
  std::string path;                       ///< "/live"
  std::vector<std::string> subprotocols;  ///< those accepted; empty: none is asked for
  Origins origins;  ///< none for endpoints with commands, so that no other site in the user's browser can
                    ///< command
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 8080;  ///< 0: any free one
};

/// Serves a page and WebSockets. When the address is a loopback address, requests for another host name are
/// refused: the name of another site cannot lead to this server.
class WebServer {
 public:
  /// Throws std::runtime_error, one sentence, when it cannot listen on the address.
  explicit WebServer(const ServerOptions& options);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Sets the page of "/". Call before the first request; `html` must outlive the server.
  void serve_page(std::string_view html);

  /// The endpoint must outlive the server.
  void add_endpoint(const EndpointOptions& options, Endpoint& endpoint);

  [[nodiscard]] int port() const;
  /// "http://127.0.0.1:8080/".
  [[nodiscard]] std::string url() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace stilt::monitor
