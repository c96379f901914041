#include "host_tools/web/monitor/web_socket_peer.h"

#include <civetweb.h>

#include <string_view>
#include <utility>

namespace stilt::monitor {
namespace {

bool loopback_address(std::string_view address) {
  return address.starts_with("127.") || address == "::1" || address.starts_with("::ffff:127.");
}

}  // namespace

WebSocketPeer::WebSocketPeer(mg_connection* connection) : connection_(connection) {
  const mg_request_info* request = mg_get_request_info(connection);
  local_ = loopback_address(static_cast<const char*>(request->remote_addr));
  if (request->acceptedWebSocketSubprotocol != nullptr) subprotocol_ = request->acceptedWebSocketSubprotocol;
  writer_ = std::thread([this] { write(); });
}

WebSocketPeer::~WebSocketPeer() { stop(); }

void WebSocketPeer::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    queue_.clear();
  }
  news_.notify_all();
  const std::lock_guard lock(joining_);
  if (writer_.joinable()) writer_.join();
}

void WebSocketPeer::send(SharedMessage message) {
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return;
    if (message->droppable && queued_bytes_ > kCongested_bytes) {
      ++dropped_;
      return;
    }
    queued_bytes_ += message->bytes.size();
    queue_.push_back(std::move(message));
    if (queued_bytes_ > kHopeless_bytes) {
      stopped_ = true;
      queue_.clear();
    }
  }
  news_.notify_one();
}

std::uint64_t WebSocketPeer::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

void WebSocketPeer::write() {
  for (;;) {
    SharedMessage message;
    {
      std::unique_lock lock(mutex_);
      news_.wait(lock, [this] { return stopped_ || !queue_.empty(); });
      if (stopped_) break;
      message = std::move(queue_.front());
      queue_.pop_front();
    }
    const int opcode = message->binary ? MG_WEBSOCKET_OPCODE_BINARY : MG_WEBSOCKET_OPCODE_TEXT;
    const int written = mg_websocket_write(connection_, opcode, message->bytes.data(), message->bytes.size());
    const std::lock_guard lock(mutex_);
    queued_bytes_ -= message->bytes.size();
    if (written <= 0) {
      stopped_ = true;
      queue_.clear();
    }
  }
  mg_websocket_write(connection_, MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE, "", 0);
}

}  // namespace stilt::monitor
