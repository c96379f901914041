#pragma once

#include <chrono>
#include <expected>
#include <string>

#include "firmware/telemetry/messages.h"
#include "firmware/telemetry/participant.h"

namespace stilt::telemetry {

/// Sends samples of one topic.
class AnyWriter {
 public:
  /// The error is one sentence.
  [[nodiscard]] static std::expected<AnyWriter, std::string> open(const Participant& participant,
                                                                  const Topic& topic);

  /// Sends a message of the topic's type. Never waits for subscribers. False: Cyclone refused it.
  bool write(const void* message) { return dds_write(writer_.get(), message) == DDS_RETCODE_OK; }

  /// Waits until the reliable subscribers have what was sent. False: not within that time.
  [[nodiscard]] bool wait_for_acks(std::chrono::nanoseconds longest) const {
    return dds_wait_for_acks(writer_.get(), longest.count()) == DDS_RETCODE_OK;
  }

  /// Subscribers that are known now.
  [[nodiscard]] int subscribers() const;

 private:
  Entity topic_;
  Entity writer_;
};

/// The same for the type T.
template <class T>
class Writer {
 public:
  Writer() = default;
  explicit Writer(AnyWriter writer) : writer_(std::move(writer)) {}
  bool write(const T& message) { return writer_.write(&message); }
  [[nodiscard]] bool wait_for_acks(std::chrono::nanoseconds longest) const {
    return writer_.wait_for_acks(longest);
  }
  [[nodiscard]] int subscribers() const { return writer_.subscribers(); }

 private:
  AnyWriter writer_;
};

}  // namespace stilt::telemetry
