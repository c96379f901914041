#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "firmware/telemetry/reader.h"
#include "host_tools/web/monitor/web_server.h"

namespace stilt::foxglove {

/// Speaks the Foxglove WebSocket protocol, so that viewers which know it (Foxglove, Lichtblick) connect
/// directly: offers every topic that a record would hold as CDR with its ROS 2 message definition, and sends
/// what a client subscribes to. Takes no commands.
///
/// Text frames are JSON with a field "op": the server says serverInfo and advertise, the client subscribe and
/// unsubscribe. A message is a binary frame: 1, id of the client's subscription (32 bits), time of day in
/// nanoseconds (64 bits), CDR; numbers are little endian.
class FoxgloveEndpoint final : public monitor::Endpoint {
 public:
  /// @param name  for people, shown by viewers
  explicit FoxgloveEndpoint(std::string name);

  /// Where it belongs on a server: the path "/" and both names of the protocol.
  /// @param viewers  sites whose pages may look; a viewer's page mostly comes from another one
  [[nodiscard]] static monitor::EndpointOptions options(monitor::Origins viewers = {.any = true});

  /// Sends a sample to everyone who subscribed to its topic. Any thread.
  /// @param time_ns  time of day
  void publish(const telemetry::Sample& sample, std::int64_t time_ns);

  /// Somebody is connected.
  [[nodiscard]] bool has_clients() const;

  void opened(const std::shared_ptr<monitor::Peer>& peer) override;
  void received(monitor::Peer& peer, bool binary, std::string_view data) override;
  void closed(monitor::Peer& peer) override;

 private:
  using Channel = std::size_t;  ///< place in channels_
  struct Client {
    std::shared_ptr<monitor::Peer> peer;
    std::map<std::uint32_t, Channel> subscriptions;  ///< by the client's number
  };
  struct Kept {
    std::string cdr;
    std::int64_t time_ns = 0;
  };

  void subscribe(Client& client, std::uint32_t subscription, std::uint64_t channel);

  std::string name_;
  std::string session_;
  std::vector<const telemetry::Topic*> channels_;
  mutable std::mutex mutex_;
  std::map<monitor::Peer*, Client> clients_;
  std::map<Channel, Kept> newest_;  ///< of topics whose newest sample is still true later
};

}  // namespace stilt::foxglove
