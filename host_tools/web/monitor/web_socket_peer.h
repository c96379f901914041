#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <string>
#include <thread>

#include "host_tools/web/monitor/web_server.h"

struct mg_connection;

namespace stilt::monitor {

/// A connection of civetweb with a queue and a writing thread, so that senders never wait.
class WebSocketPeer final : public Peer {
 public:
  /// Queued bytes above which droppable messages are left out, and above which the connection is closed.
  static constexpr std::size_t kCongested_bytes = 1U << 22U;
  static constexpr std::size_t kHopeless_bytes = 1U << 24U;

  explicit WebSocketPeer(mg_connection* connection);
  ~WebSocketPeer() override;
  WebSocketPeer(const WebSocketPeer&) = delete;
  WebSocketPeer& operator=(const WebSocketPeer&) = delete;

  void send(SharedMessage message) override;
  [[nodiscard]] std::uint64_t dropped() const override;
  [[nodiscard]] bool local() const override { return local_; }
  [[nodiscard]] const std::string& subprotocol() const override { return subprotocol_; }

  /// Stops writing and waits for the writing thread. Call before the connection is closed. Any thread; may be
  /// called again.
  void stop();

 private:
  void write();

  mg_connection* connection_;
  bool local_ = false;
  std::string subprotocol_;
  mutable std::mutex mutex_;
  std::condition_variable news_;
  std::deque<SharedMessage> queue_;
  std::size_t queued_bytes_ = 0;
  std::uint64_t dropped_ = 0;
  bool stopped_ = false;
  std::mutex joining_;  ///< the end of the server and of a connection may stop a peer at the same time
  std::thread writer_;
};

}  // namespace stilt::monitor
