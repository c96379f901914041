#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>

#include "host_tools/web/monitor/web_server.h"

namespace stilt::monitor {

/// Messages that wait for one WebSocket. What Peer has may be called from any thread, everything else from
/// the server's.
class SendQueue final : public Peer {
 public:
  /// Waiting bytes above which droppable messages are left out, and above which the connection is given up.
  /// For programs that do not return how old their data are; LiveView leaves out those of a page that is
  /// behind.
  static constexpr std::size_t kCongested_bytes = 1U << 22U;
  static constexpr std::size_t kHopeless_bytes = 1U << 24U;

  /// @param wake  called when the first message waits and when the connection is given up, from the thread
  ///              that sends. It must return at once and call nothing of this object
  SendQueue(std::string subprotocol, std::function<void()> wake);

  void send(SharedMessage message) override;
  [[nodiscard]] std::uint64_t dropped() const override;
  void hold(bool held) override { held_ = held; }
  [[nodiscard]] const std::string& subprotocol() const override { return subprotocol_; }

  [[nodiscard]] bool held() const { return held_; }

  /// The oldest message; it waits until pop(). None: nothing is to be sent.
  [[nodiscard]] SharedMessage front() const;

  /// Call when the oldest message has been sent.
  void pop();

  /// Whether so much waits that the connection is to be closed.
  [[nodiscard]] bool hopeless() const;

  /// Nothing is queued any more, and wake is no longer called.
  void close();

 private:
  const std::string subprotocol_;
  const std::function<void()> wake_;
  std::atomic<bool> held_ = false;

  mutable std::mutex mutex_;  ///< protects the members below
  std::deque<SharedMessage> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::uint64_t dropped_ = 0;
  bool closed_ = false;    ///< takes no more messages
  bool hopeless_ = false;  ///< closed, because too much waited
};

}  // namespace stilt::monitor
