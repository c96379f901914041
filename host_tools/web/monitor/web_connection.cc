#include "host_tools/web/monitor/web_connection.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/optional.hpp>
#include <string>
#include <utility>

// The library's part of the server, and ours: docs/decisions/0011-monitor.md
namespace stilt::monitor {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using beast::error_code;
using beast::role_type;
using namespace std::chrono_literals;

/// A whole request has to come within this time, and the end of a connection to be taken.
constexpr auto kPatience = 5s;
constexpr std::size_t kHead_bytes_max = 16384;

std::string text_of(beast::string_view text) { return {text.data(), text.size()}; }

/// Ends what is sent, then reads until the other end closes. A socket that is closed with bytes unread resets
/// its connection, which can take the last word away before it is read. The socket must outlive this.
template <class Handler>
void read_to_end(tcp::socket& socket, Handler handler) {
  socket.async_wait(tcp::socket::wait_read,
                    [&socket, handler = std::move(handler)](error_code error) mutable {
                      std::array<char, 4096> rest{};
                      if (!error) socket.read_some(asio::buffer(rest), error);
                      if (error && error != asio::error::would_block) return handler(error);
                      read_to_end(socket, std::move(handler));
                    });
}

/// Whether what came is the cause of an error, and not its end.
bool is_malformed(error_code error) {
  return error.category() == http::make_error_code(http::error::bad_method).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

/// Two equal headers: which of two hosts or origins is meant would be a matter of taste.
bool ambiguous(const http::fields& headers) {
  return std::ranges::any_of(
      headers, [&headers](const auto& header) { return headers.count(header.name_string()) > 1; });
}

/// A reverse proxy may serve the page under https.
bool welcome(const Origins& others, const std::string& origin, const std::string& host) {
  if (origin.empty()) return others.programs;
  return origin == "http://" + host || origin == "https://" + host || others.any ||
         std::ranges::find(others.named, origin) != others.named.end();
}

/// The first one offered that is accepted; empty: there is none.
std::string agreed_subprotocol(beast::string_view offered, const std::vector<std::string>& accepted) {
  for (const beast::string_view one : http::token_list(offered)) {
    if (std::ranges::find(accepted, text_of(one)) != accepted.end()) return text_of(one);
  }
  return {};
}

}  // namespace

/// Found by Beast; its own closes the socket after the first 2 kB that come.
template <class Handler>
void async_teardown(role_type, WebSocketTransport& socket, Handler&& handler) {
  error_code ignored;
  ignored = socket.shutdown(tcp::socket::shutdown_send, ignored);
  read_to_end(socket, std::forward<Handler>(handler));
}

WebConnection::WebConnection(tcp::socket socket, const WebSite& site,
                             std::function<void(WebConnection&)> ended)
    : site_(site),
      ended_(std::move(ended)),
      socket_(WebSocketTransport(std::move(socket))),
      received_at_(Clock::now()),
      waiting_since_(received_at_) {
  error_code ignored;
  ignored = socket_.next_layer().non_blocking(true, ignored);
  parser_.header_limit(kHead_bytes_max);
  parser_.body_limit(boost::none);  // bodies are not read
}

void WebConnection::start() {
  http::async_read_header(
      socket_.next_layer(), buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
        if (self->is_ended_) return;
        self->received_at_ = Clock::now();
        if (!error) return self->answer();
        if (error == http::error::header_limit) {
          return self->refuse(Status::request_header_fields_too_large, "The request is too long.\n");
        }
        if (!is_malformed(error)) return self->end();
        self->refuse(Status::bad_request, "This is no HTTP request.\n");
      });
}

void WebConnection::answer() {
  const Request& request = parser_.get();
  if (ambiguous(request)) return refuse(Status::bad_request, "A header comes twice.\n");
  if (!site_.names.contain(text_of(request[http::field::host]))) {
    return refuse(Status::forbidden,
                  "This host name is not the monitor's own: open the link that stilt monitor printed, or "
                  "start it with --name.\n");
  }
  if (request.method() != http::verb::get)
    return refuse(Status::method_not_allowed, "The method of a request must be GET.\n");
  if (http::token_list(request[http::field::upgrade]).exists("websocket")) return open_socket(request);
  const std::string target = text_of(request.target());
  if (target.substr(0, target.find('?')) != "/") {
    return refuse(Status::not_found, "There is one page here, at /.\n");
  }
  respond(Status::ok, "text/html", site_.html);
}

void WebConnection::respond(Status status, std::string_view type, std::string_view text) {
  response_.version(11);
  response_.result(status);
  response_.keep_alive(false);
  response_.set(http::field::content_type, std::string(type) + "; charset=utf-8");
  response_.set(http::field::cache_control, "no-store");
  response_.set("X-Content-Type-Options", "nosniff");
  response_.set(http::field::x_frame_options, "DENY");
  response_.set("Referrer-Policy", "no-referrer");
  response_.body() = text;
  response_.prepare_payload();
  http::async_write(socket_.next_layer(), response_,
                    [self = shared_from_this()](error_code error, std::size_t) {
                      if (error) return self->end();
                      self->linger();
                    });
  waiting_since_ = Clock::now();
}

void WebConnection::linger() {
  async_teardown(role_type::server, socket_.next_layer(),
                 [self = shared_from_this()](error_code) { self->end(); });
}

void WebConnection::open_socket(const Request& request) {
  const std::string target = text_of(request.target());
  const std::string path = target.substr(0, target.find('?'));
  const auto found = std::ranges::find(site_.sockets, path, [](const auto& one) { return one.options.path; });
  if (found == site_.sockets.end()) {
    return refuse(Status::not_found, "There is no WebSocket at this path.\n");
  }
  const EndpointOptions& options = found->options;
  if (!welcome(options.origins, text_of(request[http::field::origin]), text_of(request[http::field::host]))) {
    return refuse(Status::forbidden,
                  "Pages of this site may not look: start stilt monitor with --viewers.\n");
  }
  const std::string subprotocol =
      agreed_subprotocol(request[http::field::sec_websocket_protocol], options.subprotocols);
  if (buffer_.size() > 0) return refuse(Status::bad_request, "Send nothing before the WebSocket is open.\n");
  socket_.read_message_max(site_.message_bytes_max);
  socket_.auto_fragment(false);
  socket_.control_callback(
      [this](beast::websocket::frame_type, beast::string_view) { received_at_ = Clock::now(); });
  socket_.set_option(
      beast::websocket::stream_base::decorator([subprotocol](beast::websocket::response_type& response) {
        response.set(http::field::server, "stilt");
        if (!subprotocol.empty()) response.set(http::field::sec_websocket_protocol, subprotocol);
      }));
  socket_.async_accept(
      request, [self = shared_from_this(), endpoint = found->endpoint, subprotocol](error_code error) {
        if (self->is_ended_) return;
        if (error) return self->linger();
        self->begin_socket(*endpoint, subprotocol);
      });
}

void WebConnection::begin_socket(Endpoint& endpoint, const std::string& subprotocol) {
  waiting_since_.reset();
  const auto wake = [weak = weak_from_this(), executor = socket_.get_executor()] {
    asio::post(executor, [weak] {
      if (const auto self = weak.lock()) self->write();
    });
  };
  queue_ = std::make_shared<SendQueue>(subprotocol, wake);
  endpoint_ = &endpoint;
  endpoint.opened(queue_);
  read();
}

void WebConnection::read() {
  socket_.async_read_some(buffer_, 0, [self = shared_from_this()](error_code error, std::size_t) {
    if (error || self->is_ended_) return self->end();
    self->received_at_ = Clock::now();
    if (self->socket_.is_message_done()) {
      const auto bytes = self->buffer_.cdata();
      self->endpoint_->received(*self->queue_, self->socket_.got_binary(),
                                {static_cast<const char*>(bytes.data()), bytes.size()});
      self->buffer_.clear();
    }
    self->read();
  });
}

void WebConnection::write() {
  if (queue_->hopeless()) return end();
  if (writing_) return;
  const SharedMessage message = queue_->front();
  if (!message) return;
  writing_ = true;
  socket_.binary(message->binary);
  socket_.async_write(asio::buffer(message->bytes),
                      [self = shared_from_this(), message](error_code error, std::size_t) {
                        self->writing_ = false;
                        self->queue_->pop();
                        if (error) return;  // what is read says when the connection ends
                        self->write();
                      });
}

void WebConnection::say_goodbye() {
  if (!queue_) return;
  socket_.async_close(beast::websocket::close_code::normal, [self = shared_from_this()](error_code) {});
}

void WebConnection::end() {
  if (is_ended_) return;
  is_ended_ = true;
  const auto self = shared_from_this();
  error_code ignored;
  ignored = socket_.next_layer().close(ignored);
  if (queue_) {
    queue_->close();
    endpoint_->closed(*queue_);
  }
  ended_(*this);
}

bool WebConnection::late(Clock::time_point now) {
  if (queue_ && !socket_.is_open() && !waiting_since_) waiting_since_ = now;
  return waiting_since_ && now - *waiting_since_ > kPatience;
}

}  // namespace stilt::monitor
