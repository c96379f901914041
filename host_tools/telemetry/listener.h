#pragma once

#include <chrono>
#include <functional>
#include <span>
#include <vector>

#include "firmware/telemetry/reader.h"

namespace stilt::host_telemetry {

/// Subscribes to the robot's topics and receives every sample as bytes; Sample::as<T>() gives the message.
/// One thread at a time. Throws std::runtime_error with one sentence for the user when it cannot start.
class Listener {
 public:
  /// @param topics  topics to subscribe to
  /// @param keeps   largest number of samples per topic that wait for take(); 0: as many as the sender keeps
  explicit Listener(const telemetry::Participant& participant,
                    std::span<const telemetry::Topic* const> topics = telemetry::topics(), int keeps = 0);

  /// Passes the new samples of all topics to `use`, in order within a topic. Returns their number.
  int take(const std::function<void(telemetry::Sample&&)>& use);

  /// Waits for a sample, at most `longest`. False when none has arrived.
  bool wait(std::chrono::milliseconds longest);

  /// Whether the topic has a publisher.
  [[nodiscard]] bool has_publisher(const telemetry::Topic& topic) const;

  /// Samples lost in transmission, over all topics.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  std::vector<telemetry::Reader> readers_;
  telemetry::Entity waitset_;
  std::vector<telemetry::Entity> conditions_;
};

/// Joins the network as a host program. Throws std::runtime_error like Listener.
[[nodiscard]] telemetry::Participant join(const telemetry::Network& network);

}  // namespace stilt::host_telemetry
