#include "host_tools/web/foxglove/bridge.h"

#include <chrono>

#include "host_tools/recording/record/recorder.h"

namespace stilt::foxglove {
namespace {

constexpr std::chrono::milliseconds kWait{50};

}  // namespace

Bridge::Bridge(const telemetry::Network& network, FoxgloveEndpoint& endpoint)
    : participant_(host_telemetry::join(network)),
      listener_(participant_, record::Recorder::topics()),
      endpoint_(endpoint),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void Bridge::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    static_cast<void>(listener_.wait(kWait));
    listener_.take([&](telemetry::Sample&& sample) { endpoint_.publish(sample, sample.source_time_ns); });
  }
}

}  // namespace stilt::foxglove
