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

/// Implements the Foxglove WebSocket protocol, so that viewers with that protocol (Foxglove, Lichtblick)
/// connect directly. Offers every topic of a record as CDR with its ROS 2 message definition, and sends
/// the topics that a client subscribes to. Accepts no commands.
///
/// Text frames are JSON with a field "op": the server sends serverInfo and advertise, the client subscribe
/// and unsubscribe. A message is a binary frame: 1, id of the client's subscription (32 bits), time of day in
/// nanoseconds (64 bits), CDR; numbers are little endian. A client has at most as many subscriptions as there
/// are channels: each gets a copy of every message.
class FoxgloveEndpoint final : public monitor::Endpoint {
 public:
  /// @param name  name that viewers show
  explicit FoxgloveEndpoint(std::string name);

  /// Options of this endpoint on a server: the path "/" and both names of the protocol.
  /// @param viewers  web sites whose pages may connect; a viewer's page usually comes from another site
  [[nodiscard]] static monitor::EndpointOptions options(monitor::Origins viewers = {.any = true});

  /// Sends a sample to all clients that subscribed to its topic. Any thread.
  /// @param time_ns  time of day, ns
  void publish(const telemetry::Sample& sample, std::int64_t time_ns);

  /// Whether a client is connected.
  [[nodiscard]] bool has_clients() const;

  void opened(const std::shared_ptr<monitor::Peer>& peer) override;
  void received(monitor::Peer& peer, bool binary, std::string_view data) override;
  void closed(monitor::Peer& peer) override;

 private:
  using Channel = std::size_t;  ///< index in channels_
  struct Client {
    std::shared_ptr<monitor::Peer> peer;
    std::map<std::uint32_t, Channel> subscriptions;  ///< by the client's number
  };
  struct Kept {
    std::string cdr;
    std::int64_t time_ns = 0;
  };

  [[nodiscard]] bool has_room(const Client& client, std::uint32_t subscription) const;
  void subscribe(Client& client, std::uint32_t subscription, std::uint64_t channel);

  std::string name_;
  std::string session_;
  std::vector<const telemetry::Topic*> channels_;
  mutable std::mutex mutex_;
  std::map<monitor::Peer*, Client> clients_;
  std::map<Channel, Kept> newest_;  ///< of topics whose newest sample stays valid
};

}  // namespace stilt::foxglove
