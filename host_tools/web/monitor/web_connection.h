#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <tuple>
#include <vector>

#include "host_tools/web/monitor/own_names.h"
#include "host_tools/web/monitor/send_queue.h"
#include "host_tools/web/monitor/web_server.h"

namespace stilt::monitor {

/// What a server serves; unchanged while it runs.
struct WebSite {
  struct WebSocketPath {
    EndpointOptions options;
    Endpoint* endpoint;
  };
  OwnNames names;
  std::string_view html;
  std::vector<WebSocketPath> sockets{};
  std::size_t message_bytes_max = 0;
};

/// A TCP socket of which Beast ends WebSockets by the async_teardown below.
class WebSocketTransport : public boost::asio::ip::tcp::socket {
 public:
  explicit WebSocketTransport(boost::asio::ip::tcp::socket socket)
      : boost::asio::ip::tcp::socket(std::move(socket)) {}
};

/// A TCP connection of a WebServer: a request, then its answer or a WebSocket. From the server's thread.
class WebConnection final : public std::enable_shared_from_this<WebConnection> {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param site   outlives the connection
  /// @param ended  called once, by end()
  WebConnection(boost::asio::ip::tcp::socket socket, const WebSite& site,
                std::function<void(WebConnection&)> ended);

  /// Begins to read the request.
  void start();

  /// Sends the closing frame of a WebSocket, if that can be done at once.
  void say_goodbye();

  /// Closes the connection. Its endpoint gets closed() if it got opened().
  void end();

  /// Whether a request has not come, or the end of the connection has not been taken, in time.
  [[nodiscard]] bool late(Clock::time_point now);

  /// A page that commands: not to be closed.
  [[nodiscard]] bool held() const { return queue_ && queue_->held(); }

  /// The connection with the smallest worth is the first to be closed: one without a WebSocket, then the one
  /// that has been silent longest.
  [[nodiscard]] std::tuple<bool, bool, Clock::time_point> worth() const {
    return {held(), queue_ != nullptr, received_at_};
  }

 private:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;
  using Status = boost::beast::http::status;

  void answer();
  void respond(Status status, std::string_view type, std::string_view text);
  void refuse(Status status, std::string_view sentence) { respond(status, "text/plain", sentence); }
  void open_socket(const Request& request);
  void begin_socket(Endpoint& endpoint, const std::string& subprotocol);
  void read();
  void write();
  void linger();

  const WebSite& site_;
  const std::function<void(WebConnection&)> ended_;
  boost::beast::websocket::stream<WebSocketTransport, false> socket_;
  boost::beast::flat_buffer buffer_;  ///< of the request, then of one message
  boost::beast::http::request_parser<boost::beast::http::empty_body> parser_;
  boost::beast::http::response<boost::beast::http::string_body> response_;
  Clock::time_point received_at_;                   ///< when the last bytes came
  std::optional<Clock::time_point> waiting_since_;  ///< for the request, or for the other end to close
  std::shared_ptr<SendQueue> queue_;                ///< of the WebSocket; none: there is none
  Endpoint* endpoint_ = nullptr;
  bool writing_ = false;
  bool is_ended_ = false;
};

}  // namespace stilt::monitor
