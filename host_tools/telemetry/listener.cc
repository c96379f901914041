#include "host_tools/telemetry/listener.h"

#include <algorithm>
#include <stdexcept>

namespace stilt::host_telemetry {

Listener::Listener(const telemetry::Participant& participant, std::span<const telemetry::Topic* const> topics,
                   int keeps)
    : waitset_(dds_create_waitset(participant.handle())) {
  for (const telemetry::Topic* topic : topics) {
    auto reader = telemetry::Reader::open(participant, *topic, keeps);
    if (!reader) throw std::runtime_error(reader.error());
    conditions_.emplace_back(dds_create_readcondition(reader->handle(), DDS_ANY_STATE));
    dds_waitset_attach(waitset_.get(), conditions_.back().get(), 0);
    readers_.push_back(std::move(*reader));
  }
}

int Listener::take(const std::function<void(telemetry::Sample&&)>& use) {
  int taken = 0;
  for (telemetry::Reader& reader : readers_) taken += reader.take(use);
  return taken;
}

bool Listener::wait(std::chrono::milliseconds longest) {
  return dds_waitset_wait(waitset_.get(), nullptr, 0, DDS_MSECS(longest.count())) > 0;
}

bool Listener::has_publisher(const telemetry::Topic& topic) const {
  const auto reader =
      std::ranges::find_if(readers_, [&](const telemetry::Reader& r) { return &r.topic() == &topic; });
  return reader != readers_.end() && reader->senders() > 0;
}

std::uint64_t Listener::lost() const {
  std::uint64_t lost = 0;
  for (const telemetry::Reader& reader : readers_) lost += reader.lost();
  return lost;
}

telemetry::Participant join(const telemetry::Network& network) {
  auto participant = telemetry::Participant::open(network);
  if (!participant) throw std::runtime_error(participant.error());
  return std::move(*participant);
}

}  // namespace stilt::host_telemetry
