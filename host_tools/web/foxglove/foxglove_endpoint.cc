#include "host_tools/web/foxglove/foxglove_endpoint.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "firmware/telemetry/topics.h"
#include "host_tools/recording/record/recorder.h"
#include "host_tools/recording/schema/message_types.h"

namespace stilt::foxglove {
namespace {

using Json = nlohmann::json;

constexpr int kError = 2;  ///< level of a status
constexpr char kMessageData = 1;

template <class T>
void put(std::string& bytes, T value) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    bytes.push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i)));
  }
}

void send_text(monitor::Peer& peer, const Json& json) {
  peer.send(std::make_shared<monitor::Message>(monitor::Message{json.dump(), false, false}));
}

void send_error(monitor::Peer& peer, const std::string& sentence) {
  send_text(peer, {{"op", "status"}, {"level", kError}, {"message", sentence}});
}

void send_data(monitor::Peer& peer, std::uint32_t subscription, std::int64_t time_ns, std::string_view cdr,
               bool droppable) {
  std::string bytes(1, kMessageData);
  put(bytes, subscription);
  put(bytes, static_cast<std::uint64_t>(time_ns));
  bytes += cdr;
  peer.send(std::make_shared<monitor::Message>(monitor::Message{std::move(bytes), true, droppable}));
}

Json advertisement(const std::vector<const telemetry::Topic*>& channels) {
  Json list = Json::array();
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const std::string type(channels[i]->ros_type);
    list.push_back({{"id", i},
                    {"topic", record::topic_in_record(*channels[i])},
                    {"encoding", "cdr"},
                    {"schemaName", type},
                    {"schemaEncoding", "ros2msg"},
                    {"schema", schema::ros2msg_text(schema::own_messages(), type)}});
  }
  return {{"op", "advertise"}, {"channels", list}};
}

std::string time_text() {
  return std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
}

}  // namespace

FoxgloveEndpoint::FoxgloveEndpoint(std::string name)
    : name_(std::move(name)), session_(time_text()), channels_(record::Recorder::topics()) {}

monitor::EndpointOptions FoxgloveEndpoint::options(monitor::Origins viewers) {
  viewers.programs = true;
  return {"/", {"foxglove.sdk.v1", "foxglove.websocket.v1"}, std::move(viewers)};
}

bool FoxgloveEndpoint::has_clients() const {
  const std::lock_guard lock(mutex_);
  return !clients_.empty();
}

void FoxgloveEndpoint::opened(const std::shared_ptr<monitor::Peer>& peer) {
  {
    const std::lock_guard lock(mutex_);
    clients_[peer.get()] = {peer, {}};
  }
  send_text(*peer, {{"op", "serverInfo"},
                    {"name", name_},
                    {"capabilities", Json::array()},
                    {"supportedEncodings", Json::array()},
                    {"metadata", Json::object()},
                    {"sessionId", session_}});
  send_text(*peer, advertisement(channels_));
}

void FoxgloveEndpoint::closed(monitor::Peer& peer) {
  const std::lock_guard lock(mutex_);
  clients_.erase(&peer);
}

void FoxgloveEndpoint::received(monitor::Peer& peer, bool binary, std::string_view data) {
  const Json request = binary ? Json() : Json::parse(data, nullptr, false);
  const auto named = request.is_object() ? request.find("op") : request.end();
  const std::string op = named != request.end() && named->is_string() ? named->get<std::string>() : "";
  const std::lock_guard lock(mutex_);
  const auto client = clients_.find(&peer);
  if (client == clients_.end()) return;
  try {
    if (op == "subscribe") {
      for (const Json& entry : request.at("subscriptions")) {
        const auto subscription = entry.at("id").get<std::uint32_t>();
        if (!has_room(client->second, subscription)) {
          send_error(peer, "a client may have " + std::to_string(channels_.size()) +
                               " subscriptions, one of each channel; unsubscribe from one first");
          break;
        }
        subscribe(client->second, subscription, entry.at("channelId").get<std::uint64_t>());
      }
    } else if (op == "unsubscribe") {
      for (const Json& id : request.at("subscriptionIds")) {
        client->second.subscriptions.erase(id.get<std::uint32_t>());
      }
    } else {
      send_error(peer, "\"" + op + "\" is not offered here; subscribe and unsubscribe are");
    }
  } catch (const Json::exception&) {
    send_error(peer, "\"" + op + "\" lacks a field or has one of a wrong type");
  }
}

bool FoxgloveEndpoint::has_room(const Client& client, std::uint32_t subscription) const {
  return client.subscriptions.size() < channels_.size() || client.subscriptions.contains(subscription);
}

void FoxgloveEndpoint::subscribe(Client& client, std::uint32_t subscription, std::uint64_t channel) {
  if (channel >= channels_.size()) {
    return send_error(*client.peer, "there is no channel " + std::to_string(channel));
  }
  client.subscriptions[subscription] = channel;
  if (const auto kept = newest_.find(channel); kept != newest_.end()) {
    send_data(*client.peer, subscription, kept->second.time_ns, kept->second.cdr, false);
  }
}

void FoxgloveEndpoint::publish(const telemetry::Sample& sample, std::int64_t time_ns) {
  const auto at = std::ranges::find(channels_, sample.topic);
  if (at == channels_.end()) return;
  const auto channel = static_cast<Channel>(at - channels_.begin());
  const std::string_view cdr(reinterpret_cast<const char*>(sample.cdr.data()), sample.cdr.size());
  const bool lasting = sample.topic->delivery == telemetry::Delivery::lasting;
  const std::lock_guard lock(mutex_);
  if (lasting) newest_[channel] = {std::string(cdr), time_ns};
  for (auto& [peer, client] : clients_) {
    for (const auto& [subscription, subscribed] : client.subscriptions) {
      if (subscribed == channel) send_data(*peer, subscription, time_ns, cdr, !lasting);
    }
  }
}

}  // namespace stilt::foxglove
