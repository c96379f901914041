#pragma once

#include <cstddef>
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

  /// Whether the connection is kept when others need room; at first it is not.
  virtual void hold(bool held) = 0;

  /// The agreed subprotocol; empty when there is none.
  [[nodiscard]] virtual const std::string& subprotocol() const = 0;
};

/// Handler of a WebSocket path. Called from the server's thread.
class Endpoint {
 public:
  virtual ~Endpoint() = default;
  virtual void opened(const std::shared_ptr<Peer>& peer) = 0;
  virtual void received(Peer& peer, bool binary, std::string_view data) = 0;
  virtual void closed(Peer& peer) = 0;
};

/// Who may connect, besides the pages of this server.
struct Origins {
  bool any = false;                  ///< pages of every other site
  std::vector<std::string> named{};  ///< pages of these: "https://app.foxglove.dev"
  bool programs = false;             ///< programs, which send no origin
};

struct EndpointOptions {
  std::string path;                       ///< "/live"
  std::vector<std::string> subprotocols;  ///< those accepted; empty: none is asked for
  Origins origins;  ///< none for endpoints with commands, so that no other site in the user's browser can
                    ///< command
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 8080;                   ///< 0: any free one
  std::vector<std::string> names{};  ///< host names that lead here, besides those of OwnNames
  /// Connections at a time. For one more the oldest that has sent no whole request is closed, otherwise the
  /// WebSocket that has been silent longest. One that is held (Peer::hold) stays.
  std::size_t connections_max = 256;
  std::size_t message_bytes_max = 65536;  ///< of a client; a longer one ends its connection
};

/// Serves a page and WebSockets, all from one thread that waits for no client. Requests for a host name that
/// is not the server's own are refused: the name of another site cannot lead here.
class WebServer {
 public:
  /// Throws std::runtime_error, one sentence, when it cannot listen on the address.
  explicit WebServer(const ServerOptions& options);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Sets the page of "/". Call before start(); `html` must outlive the server.
  void serve_page(std::string_view html);

  /// Call before start(); the endpoint must outlive the server.
  void add_endpoint(const EndpointOptions& options, Endpoint& endpoint);

  /// Begins to accept connections.
  void start();

  [[nodiscard]] int port() const;
  /// "http://127.0.0.1:8080/".
  [[nodiscard]] std::string url() const;
  /// The same under each address at which another machine reaches this server; none on loopback.
  [[nodiscard]] std::vector<std::string> urls_for_others() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace stilt::monitor
