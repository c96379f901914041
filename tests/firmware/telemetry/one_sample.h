#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <utility>

#include "firmware/telemetry/reader.h"

namespace stilt::telemetry::testing {

/// The newest sample of a topic, off the wire: sends until one comes, which takes the time of discovery.
template <class Send>
[[nodiscard]] Sample one_sample(const Participant& participant, const Topic& topic, Send&& send) {
  Sample newest;
  auto reader = Reader::open(participant, topic);
  EXPECT_TRUE(reader.has_value());
  for (int i = 0; reader && i < 6000 && newest.topic == nullptr; ++i) {
    send();
    reader->take([&](Sample&& sample) { newest = std::move(sample); });
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return newest;
}

}  // namespace stilt::telemetry::testing
