#pragma once

#include <chrono>
#include <functional>
#include <span>
#include <vector>

#include "firmware/telemetry/reader.h"

namespace stilt::host_telemetry {

/// Receives what the robot publishes: every sample of every topic, as bytes; Sample::as<T>() gives the
/// message. One thread at a time. Throws std::runtime_error with a sentence for the user when it cannot
/// start.
class Listener {
 public:
  /// @param topics  which of them
  /// @param keeps   samples of a topic that wait for take() at most; 0: as many as the sender keeps
  explicit Listener(const telemetry::Participant& participant,
                    std::span<const telemetry::Topic* const> topics = telemetry::topics(), int keeps = 0);

  /// Gives the new samples of all topics to `use`, in order within a topic. Returns how many.
  int take(const std::function<void(telemetry::Sample&&)>& use);

  /// Waits until something came, at most so long. False: nothing did.
  bool wait(std::chrono::milliseconds longest);

  /// Whether somebody sends this topic.
  [[nodiscard]] bool has_publisher(const telemetry::Topic& topic) const;

  /// Samples lost on the way, all topics.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  std::vector<telemetry::Reader> readers_;
  telemetry::Entity waitset_;
  std::vector<telemetry::Entity> conditions_;
};

/// The participant of a host program; throws std::runtime_error like Listener.
[[nodiscard]] telemetry::Participant join(const telemetry::Network& network);

}  // namespace stilt::host_telemetry
