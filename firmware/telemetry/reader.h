#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <limits>
#include <string>

#include "firmware/telemetry/cdr.h"
#include "firmware/telemetry/participant.h"

namespace stilt::telemetry {

/// A sample that came.
struct Sample {
  const Topic* topic = nullptr;
  std::int64_t source_time_ns = 0;  ///< time of day at which it was sent, since 1970
  std::uint64_t sender = 0;         ///< differs from sender to sender
  Cdr cdr;                          ///< decode<T>(cdr) gives the message

  /// The message, null when it is not of type T.
  template <class T>
  [[nodiscard]] Owned<T> as() const {
    if (topic == nullptr || topic->type != &descriptor<T>()) return {nullptr, internal::Free{nullptr}};
    return decode<T>(cdr);
  }
};

/// Receives samples of one topic.
class Reader {
 public:
  /// @param keeps  samples kept until take(); 0: as many as the topic's sender. The error is one sentence.
  [[nodiscard]] static std::expected<Reader, std::string> open(const Participant& participant,
                                                               const Topic& topic, int keeps = 0);

  /// Gives new samples to `use`, oldest first, and returns how many. All of them; a sender that is faster
  /// than they are used would keep it from returning. A caller that must go on gives the most it takes, in
  /// steps of 64.
  int take(const std::function<void(Sample&&)>& use, int at_most = std::numeric_limits<int>::max());

  /// Senders that are known now.
  [[nodiscard]] int senders() const;

  /// Samples lost on the way so far, as far as can be known.
  [[nodiscard]] std::uint64_t lost() const;

  [[nodiscard]] dds_entity_t handle() const noexcept { return reader_.get(); }
  [[nodiscard]] const Topic& topic() const noexcept { return *about_; }

 private:
  const Topic* about_ = nullptr;
  Entity topic_;
  Entity reader_;
};

}  // namespace stilt::telemetry
