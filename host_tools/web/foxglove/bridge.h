#pragma once

#include <stop_token>
#include <string>
#include <thread>

#include "host_tools/telemetry/listener.h"
#include "host_tools/web/foxglove/foxglove_endpoint.h"

namespace stilt::foxglove {

/// Passes all telemetry of the robot to an endpoint, in its own thread. Throws std::runtime_error with one
/// sentence when the network cannot be joined.
class Bridge {
 public:
  /// The endpoint must outlive this object.
  Bridge(const telemetry::Network& network, FoxgloveEndpoint& endpoint);

 private:
  void run(const std::stop_token& stop);

  telemetry::Participant participant_;
  host_telemetry::Listener listener_;
  FoxgloveEndpoint& endpoint_;
  std::jthread thread_;  ///< last: it uses the other members
};

}  // namespace stilt::foxglove
