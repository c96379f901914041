#pragma once

#include <stop_token>
#include <thread>

#include "firmware/exchange/latest_value.h"
#include "firmware/telemetry/messages.h"
#include "firmware/telemetry/participant.h"
#include "firmware/telemetry/topics.h"
#include "host_tools/telemetry/simulation_msgs.h"

namespace stilt::telemetry {

template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<stilt_msgs_msg_dds__Simulation_>() noexcept {
  return stilt_msgs_msg_dds__Simulation__desc;
}

}  // namespace stilt::telemetry

/// What only a simulated robot knows, on the network.
namespace stilt::host_telemetry {

/// rt/stilt/simulation: best effort, keeps the newest.
extern const telemetry::Topic kSimulation;

using SimulationMessage = stilt_msgs_msg_dds__Simulation_;

/// Sends it 50 times per second from a thread of its own, so that the robot's clock never waits for the
/// network.
class SimulationPublisher {
 public:
  /// Throws std::runtime_error with a sentence when the network cannot be joined.
  explicit SimulationPublisher(const telemetry::Network& network);

  /// The newest; from one thread, wait-free.
  void offer(const SimulationMessage& message) noexcept {
    newest_.writer() = message;
    newest_.publish();
  }

 private:
  void run(const std::stop_token& stop);

  telemetry::Participant participant_;
  exchange::LatestValue<SimulationMessage> newest_;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace stilt::host_telemetry
