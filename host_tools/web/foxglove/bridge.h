#pragma once

#include <stop_token>
#include <string>
#include <thread>

#include "host_tools/telemetry/listener.h"
#include "host_tools/web/foxglove/foxglove_endpoint.h"

namespace stilt::foxglove {

/// Everything the robot says on the network, to an endpoint: a thread of its own. Throws std::runtime_error
/// with a sentence when the network cannot be joined.
class Bridge {
 public:
  /// The endpoint outlives it.
  Bridge(const telemetry::Network& network, FoxgloveEndpoint& endpoint);

 private:
  void run(const std::stop_token& stop);

  telemetry::Participant participant_;
  host_telemetry::Listener listener_;
  FoxgloveEndpoint& endpoint_;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace stilt::foxglove
