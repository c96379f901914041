#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace stilt::monitor {

/// A WebSocket message; shared by everyone it goes to.
struct Message {
  std::string bytes;
  bool binary = false;
  bool droppable = false;  ///< may be left out for a peer that does not keep up
};
using SharedMessage = std::shared_ptr<const Message>;

/// One WebSocket connection. Any thread.
class Peer {
 public:
  virtual ~Peer() = default;

  /// Queues a message and returns at once. A peer that does not keep up loses droppable messages; one that is
  /// far behind with the others is disconnected.
  virtual void send(SharedMessage message) = 0;

  /// Messages left out so far.
  [[nodiscard]] virtual std::uint64_t dropped() const = 0;

  /// The other end is this machine.
  [[nodiscard]] virtual bool local() const = 0;

  /// The subprotocol agreed on; empty without.
  [[nodiscard]] virtual const std::string& subprotocol() const = 0;
};

/// What happens on a WebSocket path. Called from the server's threads, for one peer in order.
class Endpoint {
 public:
  virtual ~Endpoint() = default;
  virtual void opened(const std::shared_ptr<Peer>& peer) = 0;
  virtual void received(Peer& peer, bool binary, std::string_view data) = 0;
  virtual void closed(Peer& peer) = 0;
};

/// Other sites whose pages may connect, beside those of this server. Programs, which name no site, always
/// may.
struct Origins {
  bool any = false;
  std::vector<std::string> named{};  ///< "https://app.foxglove.dev"
};

struct EndpointOptions {
  std::string path;                       ///< "/live"
  std::vector<std::string> subprotocols;  ///< those accepted; empty: none is asked for
  Origins origins;  ///< none for what commands, so that no other site in the user's browser can
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 8080;  ///< 0: any free one
};

/// Serves a page and WebSockets. Requests that name another host than the one listened on are refused while
/// the address is a loopback one, so that no name of somebody else's leads here.
class WebServer {
 public:
  /// Throws std::runtime_error, one sentence, when the address cannot be listened on.
  explicit WebServer(const ServerOptions& options);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// The page of "/", before anybody asks for it; `html` outlives the server.
  void serve_page(std::string_view html);

  /// The endpoint outlives the server.
  void add_endpoint(const EndpointOptions& options, Endpoint& endpoint);

  [[nodiscard]] int port() const;
  /// "http://127.0.0.1:8080/".
  [[nodiscard]] std::string url() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace stilt::monitor
