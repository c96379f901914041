#include "host_tools/telemetry/simulation_publisher.h"

#include <chrono>
#include <stdexcept>

#include "firmware/telemetry/writer.h"
#include "host_tools/telemetry/listener.h"

namespace stilt::host_telemetry {

constinit const telemetry::Topic kSimulation{
    "rt/stilt/simulation",      &stilt_msgs_msg_dds__Simulation__desc, telemetry::Delivery::stream, 1, true,
    "stilt_msgs/msg/Simulation"};

SimulationPublisher::SimulationPublisher(const telemetry::Network& network)
    : participant_(join(network)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void SimulationPublisher::run(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kPeriod{20};
  auto writer = telemetry::AnyWriter::open(participant_, kSimulation);
  if (!writer) return;
  while (!stop.stop_requested()) {
    if (newest_.has_news()) writer->write(&newest_.newest());
    std::this_thread::sleep_for(kPeriod);
  }
}

}  // namespace stilt::host_telemetry
